#include "coordinator/scene/unsettled.hpp"

#include <fmt/format.h>

#include <limits>
#include <numbers>

#include "common/geometry/bounds.hpp"
#include "common/geometry/triangle_tree.hpp"
#include "common/scene/fault.hpp"
#include "coordinator/report/own_picture.hpp"
#include "coordinator/report/preview.hpp"
#include "coordinator/results/body_meshes.hpp"
#include "coordinator/scene/show.hpp"

namespace tandem::launch {
namespace {

template <class Values>
Vec3d row_of(const Values& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

double energy_of(const Unsettled& unsettled, std::size_t i) {
  const std::uint32_t id = unsettled.spheres.id[i];
  const double r = unsettled.fill.radius[id];
  const double mass = unsettled.scene.dem->materials[unsettled.fill.material[id]].density * 4 / 3 *
                      std::numbers::pi * r * r * r;
  return 0.5 * mass *
         (norm2(row_of(unsettled.spheres.velocity, i)) +
          0.4 * r * r * norm2(row_of(unsettled.spheres.spin, i)));
}

// ", 0.006 m from wall 'cone' of 'ground'": of the centre.
std::string nearest_wall(const Unsettled& unsettled, Vec3d at) {
  double least = std::numeric_limits<double>::infinity();
  const scene::Wall* nearest = nullptr;
  const scene::Scene& scene = unsettled.scene;
  for (const scene::Wall& wall : scene.dem->walls) {
    TriangleMesh mesh = wall_mesh(wall, scene, unsettled.file.meshes, round_segments);
    if (mesh.triangles.empty()) continue;
    if (wall.body != ground) mesh = transformed(std::move(mesh), scene.mbd->bodies.at(wall.body.value).pose);
    const auto found = TriangleTree(mesh).nearest(at, least);
    if (found && found->distance < least) least = found->distance, nearest = &wall;
  }
  if (nearest == nullptr) return {};
  return fmt::format(", {:.3g} m from wall '{}' of '{}'", least, nearest->name,
                     scene.body_name(nearest->body));
}

}  // namespace

std::string what_moves(const Unsettled& unsettled) {
  const protocol::ParticlesFrame& spheres = unsettled.spheres;
  std::size_t count = 0, fastest = 0;
  double highest = -1;
  Bounds moving;
  for (std::size_t i = 0; i < spheres.id.size(); ++i) {
    if (!(energy_of(unsettled, i) >= unsettled.bound)) continue;
    ++count;
    const Vec3d p = row_of(spheres.position, i);
    moving.add(p);
    if (const double speed = norm(row_of(spheres.velocity, i)); speed > highest) highest = speed, fastest = i;
  }
  if (count == 0) return {};
  const Vec3d at = row_of(spheres.position, fastest);
  const std::uint32_t id = spheres.id[fastest];
  return fmt::format(
      "; {} of {} spheres have more than that, from {} to {} m; the fastest is sphere {} of '{}' at {} m "
      "with "
      "{:.3g} m/s{}",
      count, spheres.id.size(), scene::rounded(moving.low), scene::rounded(moving.high), id,
      unsettled.scene.dem->particles[unsettled.fill.group[id]].name, scene::rounded(at), highest,
      nearest_wall(unsettled, at));
}

void draw_unsettled(const std::filesystem::path& picture, const Unsettled& unsettled) {
  expect_own_or_new(picture);
  Frame frame = surfaces_at_start(unsettled.file);
  frame.position = unsettled.spheres.position;
  ScaleRange range;
  for (std::size_t i = 0; i < unsettled.spheres.id.size(); ++i) {
    frame.radius.push_back(unsettled.fill.radius[unsettled.spheres.id[i]]);
    frame.value.push_back(norm(row_of(unsettled.spheres.velocity, i)));
  }
  range.add(frame.value);
  draw_preview(
      picture, unsettled.file.scene, frame,
      fmt::format("{}   {} spheres that have not settled", unsettled.file.scene.name, frame.radius.size()),
      range.from_zero("speed [m/s]"));
}

}  // namespace tandem::launch
