// The folder of a run: claimed by one run at a time, which deletes nothing but what a run before it wrote.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "launch/run_folder/marker.hpp"

namespace tandem::launch {

class RunFolder {
 public:
  // Makes `folder` ready: created when missing; the files of an earlier run are removed, so that no result of
  // it can be taken for one of this. Other files stay. Error{usage} where the folder holds files but no
  // run's, is that of a run that goes on, or of another user; Error{resource} where it cannot be written to.
  // `scene`: the scene's name; `last_words`: what the last summary may take on the disk [bytes], which is
  // kept free for it.
  RunFolder(const std::filesystem::path& folder, const std::string& scene, std::int64_t last_words = 1 << 16);
  // The run ended in order.
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::filesystem::path& path() const { return folder_; }
  bool earlier_died() const { return earlier_died_; }
  // Whether another run is kept off. Not where the file system has no locks.
  bool locked() const { return locked_; }
  // What is in the folder and not of a run, at most ten names.
  const std::vector<std::string>& others() const { return others_; }

  // Error{resource} where the folder was deleted or replaced since.
  void expect_there() const;
  // Gives the space that was kept for the last summary back to the disk.
  void release_reserve() noexcept;

 private:
  void open_marker();
  void write_marker();
  void keep_reserve(std::int64_t size);
  bool is_in_place() const;

  std::filesystem::path folder_;
  Marker marker_;
  int descriptor_ = -1;  // of the marker: holds the lock
  bool earlier_died_ = false, locked_ = true;
  std::vector<std::string> others_;
};

}  // namespace tandem::launch
