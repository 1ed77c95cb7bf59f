#include "launch/coordinator/run_folder.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include "common/error.hpp"
#include "launch/verdict/status.hpp"

namespace tandem::launch {
namespace fs = std::filesystem;
namespace {

// The first file that a run writes, and what says that a folder belongs to a run.
constexpr const char* mark = "run.log";

// Status of the run in the folder, as far as this host can know: of one on another host nothing is.
std::string status_in(const fs::path& folder) {
  std::ifstream file(folder / "summary.json");
  const auto summary = file ? nlohmann::json::parse(file, nullptr, false) : nlohmann::json();
  if (!summary.is_object() || !is_of_this_host(summary)) return {};
  return status_now(summary);
}

}  // namespace

bool prepare_run_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw Error(ErrorCode::usage, "is not a folder", folder.string(), "give another --out");
  fs::create_directories(folder, error);
  if (error)
    throw Error(ErrorCode::resource, "cannot be created: " + error.message(), folder.string(),
                "give another --out");
  bool died = false;
  const bool empty = fs::is_empty(folder, error);
  if (!error && !empty) {
    if (!fs::exists(folder / mark)) {
      throw Error(ErrorCode::usage, "holds files, but none of an earlier run", folder.string(),
                  "give a new or empty folder as --out");
    }
    const std::string status = status_in(folder);
    if (status == name(Status::running))
      throw Error(ErrorCode::usage, "a run still goes on in this folder", folder.string(),
                  "wait for its end, end it, or give another --out");
    died = status == name(Status::died);
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
  return died;
}

}  // namespace tandem::launch
