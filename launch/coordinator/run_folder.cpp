#include "launch/coordinator/run_folder.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include "common/error.hpp"

namespace tandem::launch {
namespace fs = std::filesystem;
namespace {

// The first file that a run writes, and what says that a folder belongs to a run.
constexpr const char* mark = "run.log";

}  // namespace

void prepare_run_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw Error(ErrorCode::usage, "is not a folder", folder.string(), "give another --out");
  fs::create_directories(folder, error);
  if (error)
    throw Error(ErrorCode::resource, "cannot be created: " + error.message(), folder.string(),
                "give another --out");
  const bool empty = fs::is_empty(folder, error);
  if (!error && !empty) {
    if (!fs::exists(folder / mark)) {
      throw Error(ErrorCode::usage, "holds files, but none of an earlier run", folder.string(),
                  "give a new or empty folder as --out");
    }
    for (const auto& entry : fs::directory_iterator(folder)) fs::remove_all(entry.path(), error);
  }
  if (!error) {
    std::ofstream file(folder / mark);
    if (!file) error = std::error_code(errno, std::generic_category());
  }
  if (error) {
    throw Error(ErrorCode::resource, "cannot be written to: " + error.message(), folder.string(),
                "give another --out, or the right to write there");
  }
}

}  // namespace tandem::launch
