#include "coordinator/run_folder/run_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "common/error.hpp"
#include "common/file_draft.hpp"
#include "coordinator/run_folder/inputs.hpp"
#include "coordinator/run_folder/own_files.hpp"
#include "coordinator/run_folder/run_state.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& folder, int error) {
  throw Error(ErrorCode::resource, "cannot be written to: " + std::string(std::strerror(error)),
              folder.string(), "give another --out, or space on the disk and the right to write there");
}

fs::path named(const fs::path& folder) {
  if (folder.empty()) throw Error(ErrorCode::usage, "is empty", "--out", "give the name of a folder");
  return fs::absolute(folder);
}

void make(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw Error(ErrorCode::usage, "is not a folder", folder.string(), "give another --out");
  if (fs::is_symlink(folder, error) && !fs::exists(folder, error))
    throw Error(ErrorCode::usage, "is a link to a folder that does not exist", folder.string(),
                "make that folder, or give another --out");
  fs::create_directories(folder, error);
  if (error)
    throw Error(ErrorCode::resource, "cannot be created: " + error.message(), folder.string(),
                "give another --out");
}

// A folder without a marker is accepted only if it is empty.
void expect_empty(const fs::path& folder) {
  std::error_code error;
  if (fs::is_empty(folder, error) || error) return;
  const bool older = fs::exists(folder / "run.log", error) || fs::exists(folder / "summary.json", error);
  throw Error(
      ErrorCode::usage,
      older ? fmt::format("holds results but no {}: they are of an older version of tandem, or not of a run",
                          marker_name)
            : "holds files, but none of an earlier run",
      folder.string(),
      older ? "look at them, delete the folder yourself, or give a new or empty folder as --out"
            : "give a new or empty folder as --out");
}

// What a link leads to belongs to another run, or to nobody.
void expect_own_folders(const fs::path& folder) {
  for (const char* name : {frames_folder, checkpoint_folder, half_steps_folder, scene_folder}) {
    std::error_code error;
    if (fs::is_symlink(folder / name, error))
      throw Error(ErrorCode::usage, "is a link, and a run writes into its own folder only",
                  (folder / name).string(), "remove the link, or give another --out");
  }
}

[[noreturn]] void refuse_as_busy(const fs::path& folder, const std::optional<Marker>& marker) {
  throw Error(ErrorCode::usage,
              marker ? fmt::format("a run is still in progress in this folder: pid {} on {}", marker->pid,
                                   marker->host)
                     : "a run is still in progress in this folder",
              folder.string(), "wait for its end, end it (tandem stop), or give another --out");
}

}  // namespace

RunFolder::RunFolder(const fs::path& folder, const std::string& scene, std::int64_t last_words,
                     const std::vector<fs::path>& inputs)
    : folder_(named(folder)), marker_(own_marker(scene)) {
  expect_kept(inputs, folder_);
  make(folder_);
  const RunState earlier = read_run(folder_);
  if (!earlier.marker) expect_empty(folder_);
  if (earlier.marker && earlier.marker->owner != geteuid())
    throw Error(ErrorCode::usage,
                fmt::format("belongs to a run of another user (uid {})", earlier.marker->owner),
                folder_.string(), "give another --out");
  const Life life = earlier.marker && !earlier.marker->ended ? life_of(*earlier.marker) : Life::gone;
  if (life == Life::lives) refuse_as_busy(folder_, earlier.marker);
  if (life == Life::unknown)
    throw Error(
        ErrorCode::usage,
        fmt::format("a run on {} may still be in progress in this folder: its file system has no locks",
                    earlier.marker->host),
        folder_.string(),
        "give another --out; or make sure that the run is over and delete the folder yourself");
  try {
    folder_descriptor_ = open(folder_.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (folder_descriptor_ < 0) fail(folder_, errno);
    open_marker();
    expect_own_folders(folder_);
    earlier_died_ = earlier.marker && !earlier.marker->ended;
    others_ = remove_own_files(folder_);
    write_marker();
    keep_reserve(last_words);
  } catch (...) {
    if (descriptor_ >= 0) close(descriptor_);
    if (folder_descriptor_ >= 0) close(folder_descriptor_);
    throw;
  }
}

void RunFolder::open_marker() {
  const fs::path file = folder_ / marker_name;
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644);
  if (descriptor_ < 0) fail(folder_, errno);
  const Lock lock = take_lock(descriptor_);
  // Held: another run has claimed the folder. Not in place: another run has put its own marker there.
  if (lock == Lock::held || !is_in_place()) refuse_as_busy(folder_, read_marker(folder_));
  locked_ = lock == Lock::free;
}

void RunFolder::write_marker() {
  const std::string text = to_text(marker_);
  if (ftruncate(descriptor_, 0) != 0 || lseek(descriptor_, 0, SEEK_SET) != 0 ||
      !write_all(descriptor_, text) || fsync(descriptor_) != 0)
    fail(folder_, errno);
}

void RunFolder::keep_reserve(std::int64_t size) {
  const fs::path file = folder_ / reserve_name;
  const int reserve = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (reserve < 0) fail(folder_, errno);
  const int error = posix_fallocate(reserve, 0, size);
  close(reserve);
  if (error == 0) return;
  release_reserve();
  fail(folder_, error);
}

RunFolder::~RunFolder() {
  release_reserve();
  marker_.ended = true;
  const std::string text = to_text(marker_);
  // In place, with the same number of bytes, which works on a full disk. If it fails the lock is released
  // nevertheless.
  if (pwrite(descriptor_, text.data(), text.size(), 0) < 0) errno = 0;
  close(descriptor_);
  close(folder_descriptor_);
}

bool RunFolder::is_in_place() const {
  struct stat ours {};
  struct stat there {};
  return fstat(descriptor_, &ours) == 0 && lstat((folder_ / marker_name).c_str(), &there) == 0 &&
         ours.st_dev == there.st_dev && ours.st_ino == there.st_ino;
}

fs::path RunFolder::held() const {
  return "/proc/self/fd/" + std::to_string(folder_descriptor_);
}

void RunFolder::watch_files() {
  watched_.clear();
  for (const char* name : appended_files) {
    struct stat status {};
    const fs::path file = folder_ / name;
    if (lstat(file.c_str(), &status) == 0) watched_.push_back({file, status.st_dev, status.st_ino});
  }
}

void RunFolder::expect_there() const {
  constexpr const char* hint = "leave the folder of a run alone until its end";
  if (!is_in_place())
    throw Error(ErrorCode::resource, "was deleted, moved or replaced while the run went on", folder_.string(),
                hint);
  for (const Watched& watched : watched_) {
    struct stat status {};
    if (lstat(watched.file.c_str(), &status) != 0 || status.st_dev != watched.device ||
        status.st_ino != watched.inode)
      throw Error(ErrorCode::resource,
                  "was deleted, moved or replaced while the run went on: its rows are lost",
                  watched.file.string(), hint);
  }
}

void RunFolder::release_reserve() noexcept {
  // Only in the folder of this run, which may have been replaced.
  if (is_in_place()) unlink((folder_ / reserve_name).c_str());
}

}  // namespace tandem::launch
