#include "coordinator/results/series/body_series.hpp"

#include "common/error.hpp"

namespace tandem::launch {
namespace {

// constant data
constexpr const char* surfaces_file = "frames/surfaces.h5";

DatasetInfo in_file(const std::string& file, DatasetInfo info) {
  info.file = file;
  return info;
}

std::vector<double> flat(const std::vector<Vec3d>& points) {
  std::vector<double> out;
  out.reserve(3 * points.size());
  for (const Vec3d& p : points) out.insert(out.end(), {p.x, p.y, p.z});
  return out;
}

std::vector<double> placed(const std::vector<Vec3d>& points, const Pose& pose) {
  std::vector<double> out;
  out.reserve(3 * points.size());
  const Mat3d R_WB = pose.q_WB.matrix();
  for (const Vec3d& p_B : points) {
    const Vec3d p_W = pose.p_WB + R_WB * p_B;
    out.insert(out.end(), {p_W.x, p_W.y, p_W.z});
  }
  return out;
}

}  // namespace

BodySeries::BodySeries(const std::filesystem::path& folder, std::vector<BodyMesh> bodies)
    : folder_(folder), bodies_(std::move(bodies)) {
  Hdf5File file = Hdf5File::create(folder / surfaces_file);
  for (const BodyMesh& body : bodies_) {
    const std::string group = "/" + body.name;
    std::vector<std::uint32_t> corners;
    for (const auto& triangle : body.mesh.triangles)
      corners.insert(corners.end(), triangle.begin(), triangle.end());
    const std::vector<std::int32_t> owner(body.mesh.triangles.size(),
                                          static_cast<std::int32_t>(body.body.value));

    XdmfGrid grid{.name = body.name};
    grid.cells =
        in_file(surfaces_file, file.write(group + "/triangles", std::span<const std::uint32_t>(corners), 3));
    grid.points = in_file(
        surfaces_file, file.write(group + "/vertices", std::span<const double>(flat(body.mesh.vertices)), 3));
    grid.attributes.push_back(
        {"body", Center::cell, in_file(surfaces_file, file.write(group + "/body", std::span(owner)))});
    grids_.push_back(std::move(grid));
  }
  file.commit();
  index_.emplace(folder, "bodies", FixedLink{"bodies", surfaces_file});
}

void BodySeries::append(Nanoseconds time, const protocol::BodiesFrame* frame,
                        const std::vector<std::vector<CellColumn>>& columns) {
  const std::string name = index_->next_file();
  Hdf5File file = Hdf5File::create(folder_ / name);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    grids_[i].attributes.resize(1);  // without those of the frame before
    for (const CellColumn& column : columns[i])
      grids_[i].attributes.push_back({column.name, Center::cell,
                                      in_file(name, file.write("/" + bodies_[i].name + "." + column.name,
                                                               std::span<const double>(column.values),
                                                               column.width, Storage::compressed))});
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const BodyMesh& body = bodies_[i];
    if (body.body == ground) continue;
    if (frame == nullptr || body.body.value >= frame->bodies.size()) {
      throw Error(ErrorCode::internal, "the frame lacks body \"" + body.name + "\"", "results");
    }
    const Pose& pose = frame->bodies[body.body.value].pose;
    grids_[i].points = in_file(
        name, file.write("/" + body.name, std::span<const double>(placed(body.mesh.vertices, pose)), 3));
  }
  file.set_attribute("/", "time", to_seconds(time));
  file.commit();
  index_->append(to_seconds(time), grids_);
}

}  // namespace tandem::launch
