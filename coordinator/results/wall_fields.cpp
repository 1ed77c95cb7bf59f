#include "coordinator/results/wall_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "common/time.hpp"

namespace tandem::launch {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t stride = protocol::ParticlesFrame::wall_values;
// Of the sums of a triangle, see protocol::ParticlesFrame::walls.
constexpr std::size_t normal = 3, shear = 4, friction_work = 5, wear = 6;

std::vector<double> areas(const TriangleMesh& mesh) {
  std::vector<double> area;
  for (const auto& [a, b, c] : mesh.triangles)
    area.push_back(norm(cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a])) / 2);
  return area;
}

}  // namespace

WallFields::WallFields(const scene::Scene& scene, const std::vector<protocol::NamedMesh>& meshes,
                       const std::vector<BodyMesh>& bodies) {
  for (const BodyMesh& body : bodies) triangles_.push_back(body.mesh.triangles.size());
  for (const std::string& name : scene.output.wall_fields) {
    const auto wall = std::ranges::find(scene.dem->walls, name, &scene::Wall::name);
    Part part;
    part.body =
        static_cast<std::size_t>(std::ranges::find(bodies, wall->body, &BodyMesh::body) - bodies.begin());
    // The mesh of a body begins with its walls, in the order of the scene.
    for (auto other = scene.dem->walls.begin(); other != wall; ++other)
      if (other->body == wall->body)
        part.first_triangle += wall_mesh(*other, scene, meshes, round_segments).triangles.size();
    part.first_row = rows_;
    part.area = areas(wall_mesh(*wall, scene, meshes, round_segments));
    part.hardness = scene.dem->materials[wall->material.value].hardness;
    rows_ += part.area.size();
    parts_.push_back(std::move(part));
  }
}

std::vector<std::vector<CellColumn>> WallFields::of(const protocol::ParticlesFrame& frame) {
  std::vector<std::vector<CellColumn>> of_body(triangles_.size());
  if (parts_.empty()) return of_body;
  if (frame.walls.size() != rows_ * stride)
    throw Error(
        ErrorCode::protocol,
        fmt::format("a frame has {} values of walls, and the walls of output.wall_fields have {} triangles "
                    "with {} values each",
                    frame.walls.size(), rows_, stride),
        "dem_server", "send them, or do without can_observe_walls");
  const bool first = last_.empty();
  const double length = to_seconds(frame.time) - to_seconds(last_time_);
  const auto column = [&](const Part& part, const char* name, std::size_t width) -> std::vector<double>& {
    std::vector<CellColumn>& all = of_body[part.body];
    const auto known = std::ranges::find(all, name, &CellColumn::name);
    if (known != all.end()) return known->values;
    all.push_back({name, width, std::vector<double>(width * triangles_[part.body], none)});
    return all.back().values;
  };
  for (const Part& part : parts_)
    for (std::size_t i = 0; i < part.area.size(); ++i) {
      const double* sums = frame.walls.data() + (part.first_row + i) * stride;
      const double* before = first ? sums : last_.data() + (part.first_row + i) * stride;
      const std::size_t triangle = part.first_triangle + i;
      const auto mean = [&](std::size_t k) { return first ? none : (sums[k] - before[k]) / length; };
      for (std::size_t a = 0; a < 3; ++a) column(part, "force", 3)[3 * triangle + a] = mean(a);
      column(part, "pressure", 1)[triangle] = mean(normal) / part.area[i];
      column(part, "shear_stress", 1)[triangle] = mean(shear) / part.area[i];
      column(part, "friction_work", 1)[triangle] = sums[friction_work] / part.area[i];
      if (part.hardness)
        column(part, "wear_depth", 1)[triangle] = sums[wear] / (*part.hardness * part.area[i]);
    }
  last_ = frame.walls;
  last_time_ = frame.time;
  return of_body;
}

}  // namespace tandem::launch
