// A folder for states on disk, which is removed with everything in it.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "common/error.hpp"

namespace tandem::conform {

class StateFolder {
 public:
  StateFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "tandem_conform_XXXXXX").string();
    if (!mkdtemp(name.data()))
      throw Error(ErrorCode::resource, "cannot be created", name, "free some space on the disk");
    path_ = std::filesystem::canonical(name);
  }
  ~StateFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  StateFolder(const StateFolder&) = delete;
  StateFolder& operator=(const StateFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace tandem::conform
