// The folder of a run: claimed by one run at a time, which deletes only files of an earlier run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/run_folder/marker.hpp"

namespace tandem::launch {

class RunFolder {
 public:
  // Prepares `folder`: creates it when missing, and removes the files of an earlier run, so that its
  // results cannot be mistaken for those of this run. Other files stay. Throws Error{usage} where the
  // folder has files but none of a run, or belongs to a run in progress or to another user; Error{resource}
  // where it is not writable. `scene`: the scene's name; `last_words`: disk space to reserve for the last
  // summary [bytes]; `inputs`: all files and folders that the run has read or will read: Error{usage} where
  // one of them is among the files that would be removed.
  RunFolder(const std::filesystem::path& folder, const std::string& scene, std::int64_t last_words = 1 << 16,
            const std::vector<std::filesystem::path>& inputs = {});
  // Marks the run as ended in order.
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::filesystem::path& path() const { return folder_; }
  bool earlier_died() const { return earlier_died_; }
  // Whether a lock excludes other runs; false where the file system has no locks.
  bool locked() const { return locked_; }
  // Files in the folder that do not belong to a run, at most ten names.
  const std::vector<std::string>& others() const { return others_; }

  // The folder itself by a name that stays, wherever somebody moves the folder: "/proc/self/fd/7".
  std::filesystem::path held() const;

  // From now on, the logs and tables that are in the folder belong to those that expect_there() looks for.
  void watch_files();
  // Throws Error{resource} where the folder, or a file that is watched, was deleted, moved or replaced since.
  // To be called before anything is written by its name, which may be in another run's folder by now.
  void expect_there() const;
  bool is_in_place() const;
  // Releases the disk space reserved for the last summary.
  void release_reserve() noexcept;

 private:
  void open_marker();
  void write_marker();
  void keep_reserve(std::int64_t size);

  struct Watched {
    std::filesystem::path file;
    std::uint64_t device = 0, inode = 0;
  };

  std::filesystem::path folder_;
  Marker marker_;
  std::vector<Watched> watched_;
  int folder_descriptor_ = -1;
  int descriptor_ = -1;  // of the marker: holds the lock
  bool earlier_died_ = false, locked_ = true;
  std::vector<std::string> others_;
};

}  // namespace tandem::launch
