#include "launch/results/series/frame_file.hpp"

#include <fmt/format.h>

namespace tandem::launch {

std::string frame_name(int frame) {
  return fmt::format("frame_{:06}", frame);
}

std::string frame_file(const std::string& series, int frame) {
  return fmt::format("{}/{}_{:06}.h5", frames_folder, series, frame);
}

void write_frame_index(const std::filesystem::path& folder, const std::string& series, int frames,
                       const FixedLink& more) {
  Hdf5File index = Hdf5File::create(folder / (series + ".h5"));
  if (!more.name.empty()) index.link(more.name, more.file);
  for (int frame = 0; frame < frames; ++frame) index.link(frame_name(frame), frame_file(series, frame));
  index.commit();
}

}  // namespace tandem::launch
