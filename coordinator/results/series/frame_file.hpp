// A series of frames: each frame is a separate HDF5 file, frames/NAME_000012.h5, that is complete or absent,
// and NAME.h5 has a link to each. (A crash while one growing file is written may leave it unreadable: HDF5
// changes existing parts.)
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/results/series/hdf5.hpp"
#include "coordinator/results/series/xdmf.hpp"

namespace tandem::launch {

inline constexpr const char* frames_folder = "frames";

// "frame_000012", so that names are sorted in the order of the frames.
std::string frame_name(int frame);
// "frames/particles_000012.h5", relative to the run's folder.
std::string frame_file(const std::string& series, int frame);

// Decides when an index of all frames so far is rewritten: so often that it takes at most half of the time.
// Otherwise the time per frame would grow with the number of frames.
class Pace {
 public:
  bool due() const { return Clock::now() >= next_; }
  template <class Write>
  void run(Write write) {
    const auto begin = Clock::now();
    write();
    const auto end = Clock::now();
    next_ = end + (end - begin);
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point next_{};
};

// An additional link, besides those to the frames.
struct FixedLink {
  std::string name{}, file{};  // name empty: none; the file is relative to the run's folder
};
// NAME.h5, with a link to each frame, and NAME.xdmf.
class FrameIndex {
 public:
  FrameIndex(const std::filesystem::path& folder, const std::string& series, FixedLink more = {});
  // The file of the next frame, relative to the run's folder.
  std::string next_file() const { return frame_file(series_, frames_); }
  // After its file is complete.
  void append(double time, const std::vector<XdmfGrid>& grids);
  // After this, both files list all frames; before, most of them.
  void finish();

 private:
  void write();

  std::filesystem::path folder_;
  std::string series_;
  FixedLink more_;
  XdmfSeries xdmf_;
  Pace pace_;
  int frames_ = 0, in_index_ = -1;
};

}  // namespace tandem::launch
