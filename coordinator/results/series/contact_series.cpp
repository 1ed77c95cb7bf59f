#include "coordinator/results/series/contact_series.hpp"

#include <numeric>

#include "common/time.hpp"

namespace tandem::launch {

ContactSeries::ContactSeries(const std::filesystem::path& folder)
    : folder_(folder), index_(folder, "contacts") {}

void ContactSeries::append(const protocol::ParticlesFrame& frame) {
  constexpr std::size_t stride = protocol::ParticlesFrame::of_bodies_values;
  const std::size_t count = frame.of_bodies.size() / stride;
  std::vector<double> point, force;
  std::vector<std::int32_t> body;
  std::vector<std::uint32_t> sphere, points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double* contact = frame.of_bodies.data() + stride * i;
    body.push_back(static_cast<std::int32_t>(contact[0]));
    sphere.push_back(static_cast<std::uint32_t>(contact[1]));
    point.insert(point.end(), contact + 2, contact + 5);
    force.insert(force.end(), contact + 5, contact + 8);
  }
  std::iota(points.begin(), points.end(), 0u);
  const std::string name = index_.next_file();
  Hdf5File file = Hdf5File::create(folder_ / name);
  const auto write = [&]<class T>(const char* dataset, const std::vector<T>& values,
                                  std::size_t columns = 1) {
    DatasetInfo info = file.write(dataset, std::span<const T>(values), columns);
    info.file = name;
    return info;
  };
  XdmfGrid grid{.name = "contacts", .points = write("/point", point, 3), .cells = write("/points", points)};
  grid.attributes = {{"force", Center::node, write("/force", force, 3)},
                     {"body", Center::node, write("/body", body)},
                     {"sphere", Center::node, write("/sphere", sphere)}};
  const double time = to_seconds(frame.time);
  file.set_attribute("/", "time", time);
  file.commit();
  index_.append(time, {grid});
}

}  // namespace tandem::launch
