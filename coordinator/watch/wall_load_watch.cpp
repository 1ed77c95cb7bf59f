#include "coordinator/watch/wall_load_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

constexpr double pressing_overlap =
    1e-3;  // of the radius: far above the rounding of radii in single precision

// Of larger frames every so many spheres are tried, others in each frame.
constexpr std::size_t most_tests = 2'000'000;  // of a sphere with a face

}  // namespace

WallLoadWatch::WallLoadWatch(const scene::Scene& scene) {
  const scene::Dem& dem = scene.dem.value();
  const bool fixed_spheres =
      std::ranges::any_of(dem.particles, [](const scene::ParticleGroup& group) { return group.fixed; });
  ground_has_walls_ = fixed_spheres || std::ranges::any_of(dem.walls, [](const scene::Wall& wall) {
                        return wall.body == ground;
                      });
  // Fixed spheres may lie in walls without a contact.
  if (fixed_spheres) return;
  for (const scene::Wall& wall : dem.walls) add(wall);
}

void WallLoadWatch::add(const scene::Wall& wall) {
  const auto in_body = [&](Vec3d direction) { return wall.pose.q_WB.rotate(direction); };
  constexpr double endless = std::numeric_limits<double>::infinity();
  if (const auto* plane = std::get_if<scene::PlaneShape>(&wall.shape))
    faces_[wall.body.value].push_back({wall.name,
                                       wall.pose.p_WB + in_body(plane->point),
                                       in_body((1 / norm(plane->normal)) * plane->normal),
                                       {},
                                       {},
                                       endless,
                                       endless,
                                       false});
  const auto* box = std::get_if<scene::BoxShape>(&wall.shape);
  if (!box) return;
  constexpr Vec3d axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int k = 0; k < 3; ++k)
    for (const double side : {-1.0, 1.0}) {
      const std::string face = std::string(side > 0 ? "+" : "-") + "xyz"[k];
      if (std::ranges::find(box->open, face) != box->open.end()) continue;
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      faces_[wall.body.value].push_back(
          {wall.name, wall.pose.p_WB + in_body((0.5 * side * box->size[k]) * axes[k]), in_body(axes[k]),
           in_body(axes[i]), in_body(axes[j]), 0.5 * box->size[i], 0.5 * box->size[j], true});
    }
}

void WallLoadWatch::record(const Exchange& exchange) const {
  if (ground_has_walls_ || !is_loaded(ground.value, exchange)) return;
  throw Error(ErrorCode::protocol, "the ground has a load, and the scene no wall of the ground", "dem_server",
              "use a particle participant that records each load on the body of its wall: tandem conform "
              "--role dem --check weight_on_body");
}

bool WallLoadWatch::is_loaded(std::uint32_t body, const Exchange& exchange) {
  return std::ranges::any_of(exchange.load.bodies, [body](const protocol::BodyLoad& load) {
    return load.body == body &&
           norm(load.mean.force) + norm(load.end.force) + norm(load.mean.torque) + norm(load.end.torque) > 0;
  });
}

void WallLoadWatch::observe(const protocol::ParticlesFrame& frame, const Exchange& exchange) {
  if (frame.time != exchange.load.window.end) return;
  const protocol::LoadSet& load = exchange.load;
  const double just_now = 2 * to_seconds(load.window.end - load.window.begin) /
                          static_cast<double>(std::max<std::uint64_t>(load.account.micro_steps, 1));  // [s]
  std::size_t tests_per_sphere = 0;
  for (const auto& [body, faces] : faces_)
    if (!is_loaded(body, exchange)) tests_per_sphere += faces.size();
  for (const auto& [body, faces] : faces_) {
    if (is_loaded(body, exchange)) continue;
    Pose pose;
    Twist twist;
    if (body != ground.value) {
      const auto path = std::ranges::find(exchange.path.bodies, body, &protocol::BodyMotion::body);
      if (path == exchange.path.bodies.end()) continue;
      pose = path->end_pose, twist = path->end_twist;
    }
    std::uint64_t pressing = 0;
    Vec3d normals;
    std::string example;
    const std::size_t stride = frame.id.size() * tests_per_sphere / most_tests + 1;
    for (std::size_t i = exchange.load.window.index % stride; i < frame.id.size(); i += stride) {
      const Vec3d x{frame.position[3 * i], frame.position[3 * i + 1], frame.position[3 * i + 2]},
          arm = x - pose.p_WB, place = pose.q_WB.conjugate().rotate(arm);
      const Vec3d v =
          Vec3f{frame.velocity[3 * i], frame.velocity[3 * i + 1], frame.velocity[3 * i + 2]}.as<double>() -
          twist.v_WB - cross(twist.w_WB, arm);
      const auto radius = static_cast<double>(frame.radius[i]);
      for (const Face& face : faces) {
        const Vec3d from = place - face.point;
        const double height = dot(from, face.normal), distance = face.two_sided ? std::abs(height) : height;
        if (!(distance > 0 && distance < (1 - pressing_overlap) * radius)) continue;
        if (face.two_sided &&
            !(std::abs(dot(from, face.u)) < face.half_u && std::abs(dot(from, face.v)) < face.half_v))
          continue;
        const Vec3d normal = pose.q_WB.rotate(height > 0 ? face.normal : -face.normal);
        const double approach = -dot(v, normal);
        if (approach < 0) continue;
        // In the last micro step forces are those of its beginning, when the sphere may not have been there.
        if (!(distance + approach * just_now < (1 - pressing_overlap) * radius)) continue;
        normals += normal;
        if (++pressing == 1)
          example = fmt::format("sphere {} overlaps wall '{}' by {:.3g} m", frame.id[i], face.wall,
                                radius - distance);
      }
    }
    // Forces from opposite sides may cancel.
    if (!(norm(normals) > 0.5 * static_cast<double>(pressing))) continue;
    const std::scoped_lock lock(*mutex_);
    UnloadedWalls& worst = unloaded_[body];
    if (pressing > worst.spheres) worst = {pressing, to_seconds(frame.time), example};
  }
}

}  // namespace tandem::launch
