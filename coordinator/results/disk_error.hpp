// The one error for a results file that cannot be written.
#pragma once

#include <filesystem>
#include <string>

#include "common/error.hpp"

namespace tandem::launch {

[[noreturn]] inline void fail_on_disk(const std::filesystem::path& file, const std::string& problem) {
  throw Error(ErrorCode::resource, problem, file.string(),
              "is the folder there and writable, and is there space left on the disk?");
}

}  // namespace tandem::launch
