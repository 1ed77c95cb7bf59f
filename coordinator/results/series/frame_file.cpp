#include "coordinator/results/series/frame_file.hpp"

#include <fmt/format.h>

#include <utility>

namespace tandem::launch {

std::string frame_name(int frame) {
  return fmt::format("frame_{:06}", frame);
}

std::string frame_file(const std::string& series, int frame) {
  return fmt::format("{}/{}_{:06}.h5", frames_folder, series, frame);
}

FrameIndex::FrameIndex(const std::filesystem::path& folder, const std::string& series, FixedLink more)
    : folder_(folder), series_(series), more_(std::move(more)), xdmf_(folder / (series + ".xdmf")) {
  write();
}

void FrameIndex::append(double time, const std::vector<XdmfGrid>& grids) {
  ++frames_;
  xdmf_.append(time, grids);
  if (pace_.due()) write();
}

void FrameIndex::finish() {
  if (in_index_ != frames_) write();
}

void FrameIndex::write() {
  pace_.run([this] {
    Hdf5File index = Hdf5File::create(folder_ / (series_ + ".h5"));
    if (!more_.name.empty()) index.link(more_.name, more_.file);
    for (int frame = 0; frame < frames_; ++frame) index.link(frame_name(frame), frame_file(series_, frame));
    index.commit();
    xdmf_.write();
  });
  in_index_ = frames_;
}

}  // namespace tandem::launch
