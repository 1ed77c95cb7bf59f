// A series of frames: each frame is an HDF5 file of its own, frames/NAME_000012.h5, that is there as a whole
// or not at all, and NAME.h5 has a link to each. (In one growing file a death in the midst of a write may
// leave what no program can read: HDF5 changes what is there already.)
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "launch/results/series/hdf5.hpp"

namespace tandem::launch {

inline constexpr const char* frames_folder = "frames";

// "frame_000012", so that names sort as the frames do.
std::string frame_name(int frame);
// "frames/particles_000012.h5", relative to the run's folder.
std::string frame_file(const std::string& series, int frame);

// A file that tells about all frames so far is written anew as often as takes at most half of the time: then
// the time of a frame does not grow without bound with the frames before it.
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

// A link beside those to the frames.
struct FixedLink {
  std::string name{}, file{};  // name empty: none; the file is relative to the run's folder
};
// Writes NAME.h5 with links to the frames 0 to `frames` - 1.
void write_frame_index(const std::filesystem::path& folder, const std::string& series, int frames,
                       const FixedLink& more = {});

}  // namespace tandem::launch
