#include "coordinator/report/regions.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "common/scene/motion_function.hpp"

namespace tandem::launch {
namespace {

using Lines = std::vector<std::pair<Vec3d, Vec3d>>;

constexpr Vec3d wall_colour{0.45, 0.49, 0.54}, sensor_colour{0.0, 0.45, 0.70}, inlet_colour{0.0, 0.62, 0.45},
    outlet_colour{0.80, 0.32, 0.0};

Vec3d placed(const Pose& pose, Vec3d p) {
  return pose.p_WB + pose.q_WB.rotate(p);
}

// The pose in the world of something that a body carries, at the start.
Pose in_world(const scene::Scene& scene, BodyId body, const Pose& pose) {
  if (body == ground) return pose;
  const Pose& at = scene.mbd->bodies.at(body.value).pose;
  return {placed(at, pose.p_WB), at.q_WB * pose.q_WB};
}

Lines box_lines(Vec3d low, Vec3d high, const Pose& pose) {
  Lines lines;
  for (int axis = 0; axis < 3; ++axis)
    for (int edge = 0; edge < 4; ++edge) {
      Vec3d a = low;
      a[(axis + 1) % 3] = edge & 1 ? high[(axis + 1) % 3] : low[(axis + 1) % 3];
      a[(axis + 2) % 3] = edge & 2 ? high[(axis + 2) % 3] : low[(axis + 2) % 3];
      Vec3d b = a;
      b[axis] = high[axis];
      lines.emplace_back(placed(pose, a), placed(pose, b));
    }
  return lines;
}

void add_circle(Lines& lines, double radius, double z, const Pose& pose) {
  constexpr int segments = 32;
  const auto point = [&](int k) {
    const double angle = 2 * std::numbers::pi * k / segments;
    return placed(pose, {radius * std::cos(angle), radius * std::sin(angle), z});
  };
  for (int k = 0; k < segments; ++k) lines.emplace_back(point(k), point(k + 1));
}

Lines cylinder_lines(double radius, double height, const Pose& pose) {
  Lines lines;
  for (const double z : {-0.5 * height, 0.5 * height}) add_circle(lines, radius, z, pose);
  for (const double x : {-radius, radius})
    lines.emplace_back(placed(pose, {x, 0, -0.5 * height}), placed(pose, {x, 0, 0.5 * height}));
  return lines;
}

Lines rectangle_lines(double x, double y, const Pose& pose) {
  const Vec3d corner[4] = {{-x / 2, -y / 2, 0}, {x / 2, -y / 2, 0}, {x / 2, y / 2, 0}, {-x / 2, y / 2, 0}};
  Lines lines;
  for (int i = 0; i < 4; ++i) lines.emplace_back(placed(pose, corner[i]), placed(pose, corner[(i + 1) % 4]));
  return lines;
}

Region region_of(const scene::Scene& scene, const scene::ParticleSensor& sensor) {
  const Pose pose = in_world(scene, sensor.body, sensor.pose);
  Region region{fmt::format("{} (sensor)", sensor.name), pose.p_WB, sensor_colour};
  if (!sensor.wall.empty()) return region;
  if (const auto* box = std::get_if<scene::BoxShape>(&sensor.shape))
    region.lines = box_lines(-0.5 * box->size, 0.5 * box->size, pose);
  else if (const auto& cylinder = std::get<scene::CylinderShape>(sensor.shape); cylinder.height)
    region.lines = cylinder_lines(cylinder.radius, *cylinder.height, pose);
  return region;
}

// Levels, loads and pressures have no region; a pressure may have a rectangle.
Region region_of(const scene::Scene& scene, const scene::LiquidSensor& sensor) {
  Region region = region_of(scene, static_cast<const scene::ParticleSensor&>(sensor));
  if (sensor.kind == scene::LiquidSensor::Kind::region) return region;
  region.lines.clear();
  if (sensor.area)
    region.lines = rectangle_lines(sensor.area->x, sensor.area->y, in_world(scene, sensor.body, sensor.pose));
  return region;
}

Region region_of(const scene::LiquidInlet& inlet) {
  Region region{fmt::format("{} (inlet)", inlet.name), inlet.pose.p_WB, inlet_colour};
  if (const auto* rectangle = std::get_if<scene::RectangleShape>(&inlet.shape))
    region.lines = rectangle_lines(rectangle->x, rectangle->y, inlet.pose);
  else
    add_circle(region.lines, std::get<scene::DiscShape>(inlet.shape).radius, 0, inlet.pose);
  return region;
}

// Of a half-space the point on its plane that is nearest to the middle of the domain.
Region region_of(const scene::Scene& scene, const scene::Outlet& outlet) {
  Region region{fmt::format("{} (outlet)", outlet.name), {}, outlet_colour};
  if (const auto* box = std::get_if<scene::Box>(&outlet.region)) {
    region.at = 0.5 * (box->min + box->max);
    region.lines = box_lines(box->min, box->max, {});
    return region;
  }
  const auto& half = std::get<scene::HalfSpace>(outlet.region);
  const scene::Box domain = scene.domain();
  const Vec3d middle = 0.5 * (domain.min + domain.max);
  region.at = middle - dot(middle - half.point, half.normal) * half.normal;
  return region;
}

// Where the name of a wall of the ground stands.
Vec3d middle_of(const scene::Scene& scene, const scene::Wall& wall) {
  const auto* plane = std::get_if<scene::PlaneShape>(&wall.shape);
  if (!plane) return wall.pose.p_WB;
  const scene::Box domain = scene.domain();
  const Vec3d normal = normalized(wall.pose.q_WB.rotate(plane->normal)),
              middle = 0.5 * (domain.min + domain.max);
  return middle - dot(middle - placed(wall.pose, plane->point), normal) * normal;
}

// A point on the surface of the wall and the normal there, where a velocity along `direction` shows best:
// on top. Absent for shapes of which only the mesh knows it.
std::optional<std::pair<Vec3d, Vec3d>> top_of(const scene::Wall& wall, Vec3d direction, Vec3d up,
                                              double& length) {
  if (const auto* box = std::get_if<scene::BoxShape>(&wall.shape)) {
    int best = 0;  // axis of the box that is most upright
    double most = -1, side = 1;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d e{};
      e[axis] = 1;
      const double share = dot(wall.pose.q_WB.rotate(e), up);
      if (std::abs(share) > most) best = axis, most = std::abs(share), side = share < 0 ? -1 : 1;
    }
    Vec3d centre{}, normal{};
    centre[best] = side * 0.5 * box->size[best], normal[best] = side;
    const Vec3d along = wall.pose.q_WB.conjugate().rotate(direction);
    length =
        std::abs(along.x) * box->size.x + std::abs(along.y) * box->size.y + std::abs(along.z) * box->size.z;
    return std::pair{placed(wall.pose, centre), wall.pose.q_WB.rotate(normal)};
  }
  if (const auto* cylinder = std::get_if<scene::CylinderShape>(&wall.shape)) {
    const Vec3d axis = wall.pose.q_WB.rotate({0, 0, 1}), out = up - dot(up, axis) * axis;
    if (norm(out) < 1e-9) return {};
    length = 2 * cylinder->radius;
    return std::pair{wall.pose.p_WB + cylinder->radius * normalized(out), normalized(out)};
  }
  return {};
}

}  // namespace

std::vector<Region> regions_of(const scene::Scene& scene) {
  std::vector<Region> regions;
  if (scene.dem) {
    for (const scene::ParticleGroup& group : scene.dem->particles)
      if (const auto* fill = std::get_if<scene::InletFill>(&group.fill))
        regions.push_back({fmt::format("{} (inlet)", group.name), 0.5 * (fill->min + fill->max), inlet_colour,
                           box_lines(fill->min, fill->max, {})});
    for (const scene::Outlet& outlet : scene.dem->outlets) regions.push_back(region_of(scene, outlet));
    for (const scene::ParticleSensor& sensor : scene.dem->sensors)
      regions.push_back(region_of(scene, sensor));
  }
  if (scene.sph) {
    for (const scene::LiquidInlet& inlet : scene.sph->inlets) regions.push_back(region_of(inlet));
    for (const scene::Outlet& outlet : scene.sph->outlets) regions.push_back(region_of(scene, outlet));
    for (const scene::LiquidSensor& sensor : scene.sph->sensors) regions.push_back(region_of(scene, sensor));
  }
  if (scene.has_particles())
    for (const scene::Wall& wall : scene.walls())
      if (wall.body == ground && !wall.name.empty())
        regions.push_back({fmt::format("{} (wall)", wall.name), middle_of(scene, wall), wall_colour});
  return regions;
}

std::vector<Arrow> belt_arrows(const scene::Scene& scene, const Frame& frame) {
  std::vector<Arrow> arrows;
  if (!scene.has_particles()) return arrows;
  const Vec3d up = norm2(scene.gravity) > 0 ? normalized(-scene.gravity) : Vec3d{0, 0, 1};
  for (const scene::Wall& wall : scene.walls()) {
    if (!wall.surface_velocity) continue;
    const double speed =
        scene::MotionFunction(wall.surface_velocity->speed, scene::FunctionOf::force).at(frame.time).value;
    if (speed == 0) continue;
    // In the frame of the body, and from there to the world of the frame.
    const PlacedFrame* moved = nullptr;
    if (wall.body != ground)
      for (const Surface& surface : frame.surfaces)
        if (surface.name == scene.body_name(wall.body) && surface.frame) moved = &*surface.frame;
    if (wall.body != ground && !moved) continue;
    const Vec3d body_up =
        wall.body == ground ? up : scene.mbd->bodies.at(wall.body.value).pose.q_WB.conjugate().rotate(up);
    const Vec3d direction = speed > 0 ? wall.surface_velocity->direction : -wall.surface_velocity->direction;
    double length = 0;
    const auto top = top_of(wall, direction, body_up, length);
    if (!top) continue;
    const Vec3d along = direction - dot(direction, top->second) * top->second;
    if (norm(along) < 1e-6) continue;
    // Three arrows in a row along the belt.
    for (const int k : {-1, 0, 1}) {
      const Vec3d centre = top->first + k / 3.0 * length * normalized(along),
                  half = 0.09 * length * normalized(along);
      Arrow arrow{centre - half, centre + half, top->second};
      if (moved) {
        const Vec3d tip = moved->point(arrow.from + arrow.normal);
        arrow = {moved->point(arrow.from), moved->point(arrow.to), tip - moved->point(arrow.from)};
      }
      arrows.push_back(arrow);
    }
  }
  return arrows;
}

}  // namespace tandem::launch
