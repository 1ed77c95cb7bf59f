#include "launch/results/series/particle_series.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

namespace tandem::launch {

std::string frame_group(int frame) {
  return fmt::format("/frame_{:06}", frame);
}

ParticleSeries::ParticleSeries(const std::filesystem::path& folder)
    : file_(Hdf5File::create(folder / "particles.h5")), xdmf_(folder / "particles.xdmf", "particles.h5") {}

void ParticleSeries::append(const protocol::ParticlesFrame& frame) {
  std::vector<float> speed(frame.id.size());
  for (std::size_t i = 0; i < speed.size(); ++i) {
    speed[i] = std::hypot(frame.velocity[3 * i], frame.velocity[3 * i + 1], frame.velocity[3 * i + 2]);
  }
  // Radius and id hardly change from one particle to the next and shrink to nothing; the rest is noise to a
  // compressor.
  const std::string group = frame_group(frames_++);
  XdmfGrid grid{.name = "particles",
                .points = file_.write(group + "/position", std::span(frame.position), 3)};
  if (points_.path.empty() ||
      points_.rows != frame.id.size()) {  // 0, 1, 2, ... anew only when a particle is lost
    std::vector<std::uint32_t> points(frame.id.size());
    std::iota(points.begin(), points.end(), 0u);
    points_ = file_.write(group + "/points", std::span<const std::uint32_t>(points), 1, Storage::compressed);
  }
  grid.cells = points_;
  const auto add = [&grid](const char* name, DatasetInfo array) {
    grid.attributes.push_back({name, Center::node, std::move(array)});
  };
  add("radius", file_.write(group + "/radius", std::span(frame.radius), 1, Storage::compressed));
  add("speed", file_.write(group + "/speed", std::span<const float>(speed)));
  add("velocity", file_.write(group + "/velocity", std::span(frame.velocity), 3));
  add("spin", file_.write(group + "/spin", std::span(frame.spin), 3));
  add("id", file_.write(group + "/id", std::span(frame.id), 1, Storage::compressed));
  const double time = to_seconds(frame.time);
  file_.set_attribute(group, "time", time);
  file_.flush();
  xdmf_.append(time, {grid});
}

}  // namespace tandem::launch
