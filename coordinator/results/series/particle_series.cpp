#include "coordinator/results/series/particle_series.hpp"

#include <cmath>
#include <numeric>

namespace tandem::launch {

ParticleSeries::ParticleSeries(const std::filesystem::path& folder, const std::string& name)
    : folder_(folder), name_(name), index_(folder, name) {}

void ParticleSeries::append(const protocol::ParticlesFrame& frame, const std::vector<Column>& columns) {
  std::vector<float> speed(frame.id.size());
  for (std::size_t i = 0; i < speed.size(); ++i) {
    speed[i] = std::hypot(frame.velocity[3 * i], frame.velocity[3 * i + 1], frame.velocity[3 * i + 2]);
  }
  const std::string name = index_.next_file();
  Hdf5File file = Hdf5File::create(folder_ / name);
  const auto write = [&]<class T>(const char* dataset, const std::vector<T>& values,
                                  std::size_t per_sphere = 1, Storage storage = Storage::plain) {
    DatasetInfo info = file.write(dataset, std::span<const T>(values), per_sphere, storage);
    info.file = name;
    return info;
  };
  // Radius and id hardly differ between neighbouring particles and compress well; the other data do not
  // compress.
  XdmfGrid grid{.name = name_, .points = write("/position", frame.position, 3)};
  // 0, 1, 2, ... are rewritten only after a change of the number of particles.
  if (points_.path.empty() || points_.rows != frame.id.size()) {
    std::vector<std::uint32_t> points(frame.id.size());
    std::iota(points.begin(), points.end(), 0u);
    points_ = write("/points", points, 1, Storage::compressed);
  }
  grid.cells = points_;
  const auto add = [&grid](const char* attribute, DatasetInfo array) {
    grid.attributes.push_back({attribute, Center::node, std::move(array)});
  };
  add("radius", write("/radius", frame.radius, 1, Storage::compressed));
  add("speed", write("/speed", speed));
  add("velocity", write("/velocity", frame.velocity, 3));
  add("spin", write("/spin", frame.spin, 3));
  add("id", write("/id", frame.id, 1, Storage::compressed));
  for (const Column& column : columns)
    std::visit(
        [&](const auto& values) {
          add(column.name.c_str(), write(("/" + column.name).c_str(), values, 1, Storage::compressed));
        },
        column.values);
  const double time = to_seconds(frame.time);
  file.set_attribute("/", "time", time);
  file.commit();
  index_.append(time, {grid});
}

}  // namespace tandem::launch
