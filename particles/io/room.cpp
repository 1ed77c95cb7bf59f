#include "particles/io/room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "common/scene/shape_mesh.hpp"
#include "particles/io/overlaps.hpp"
#include "particles/io/room_meshes.hpp"
#include "particles/io/sphere_neighbours.hpp"

namespace tandem::particles {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr int columns_along = 512;

}  // namespace

Room::Room(const scene::Scene& scene, std::size_t group, const Surface& surface,
           const std::vector<NamedMesh>& meshes, ThreadPool& pool)
    : surface_(surface) {
  const auto& fill = std::get<scene::PackingFill>(scene.dem->particles[group].fill);
  region_ = fill.region;
  where_ = "dem.particles[" + std::to_string(group) + "].fill";
  for (const BodyId body : surface.boundary_bodies) poses_.push_back(start_pose(body, scene));
  std::string_view container;
  if (const auto* inside = std::get_if<scene::InsideWall>(&region_)) {
    container = inside->wall;
    const scene::Wall& wall = room::wall_named(scene, inside->wall);
    const Pose pose = room::pose_of(wall, scene);
    frame_ = room::frame_of(scene, pose);
    TriangleMesh mesh = room::closed_mesh(wall, meshes);
    if (mesh.triangles.empty())
      throw Error(ErrorCode::scene, "the wall '" + wall.name + "' does not end on all sides",
                  where_ + ".region.wall",
                  "name a closed wall, or give a region of type 'box' or 'cylinder'");
    mesh = room::placed(std::move(mesh), pose, frame_);
    const double above_origin = dot(frame_.origin, frame_.to_world * Vec3d{0, 0, 1});
    const double open = lowest_open_edge(mesh), level = fill.level ? *fill.level - above_origin : infinite;
    if (open < level)
      throw Error(ErrorCode::scene,
                  "the wall '" + wall.name + "' has open edges down to " +
                      scene::rounded(open + above_origin) + " m" +
                      (fill.level ? ", below the level of " + scene::text(*fill.level) + " m" : ""),
                  where_ + ".region.wall",
                  std::string(fill.level ? "give a level below its openings, or close them"
                                         : "give a level below its openings, as a distance above the world's "
                                           "origin") +
                      "; a region of type 'above' fills a funnel down to its mouth");
    boundary_.emplace(std::move(mesh));
    low_ = boundary_->low();
    high_ = boundary_->high();
    high_.z = std::min(high_.z, level);
  } else if (const auto* above = std::get_if<scene::AboveWall>(&region_)) {
    frame_ = room::frame_of(scene, {});
    const scene::Wall& wall = room::wall_named(scene, above->wall);
    TriangleMesh mesh = room::surface_mesh(wall, meshes);
    if (mesh.triangles.empty())
      throw Error(ErrorCode::scene, "the wall '" + wall.name + "' does not end on all sides",
                  where_ + ".region.wall", "name a height field, a mesh, a cone or another shape that ends");
    boundary_.emplace(
        room::with_closed_mouths(room::placed(std::move(mesh), room::pose_of(wall, scene), frame_)));
    low_ = boundary_->low();
    high_ = boundary_->high();
    outline_ = PlanOutline(
        boundary_->mesh(), [this](double x, double y) { return std::isfinite(ground(x, y)); },
        scene.dem->particles[group].radius_max);
    high_.z = above->height ? high_.z + *above->height : *fill.level;
    if (above->min)
      for (int a = 0; a < 2; ++a) {
        low_[a] = (*above->min)[static_cast<std::size_t>(a)];
        high_[a] = (*above->max)[static_cast<std::size_t>(a)];
      }
  } else if (const auto* between = std::get_if<scene::BetweenWalls>(&region_)) {
    frame_ = room::frame_of(scene, {});
    boundary_.emplace(room::hull_of(between->walls, scene, meshes, frame_, where_));
    low_ = boundary_->low();
    high_ = boundary_->high();
    if (fill.level) high_.z = std::min(high_.z, *fill.level);
    for (const auto& t : boundary_->mesh().triangles) {
      const Vec3d a = boundary_->mesh().vertices[t[0]], b = boundary_->mesh().vertices[t[1]],
                  c = boundary_->mesh().vertices[t[2]];
      faces_.push_back({a, normalized(cross(b - a, c - a))});
    }
  } else {
    frame_ = room::frame_of(scene, {});
    boundary_.emplace(room::region_mesh(region_, frame_));
    low_ = boundary_->low();
    high_ = boundary_->high();
    if (fill.level) high_.z = std::min(high_.z, *fill.level);
  }
  if (!(high_.z > low_.z))
    throw Error(ErrorCode::scene,
                "the level of " + scene::text(fill.level.value_or(0)) + " m is below the region",
                where_ + ".level", "give a higher level; it is a distance above the world's origin");
  find_solids(scene, meshes, container);
  make_columns(pool);
  if (!(volume() > 0))
    throw Error(ErrorCode::scene, "there is no room in the region: it is in solids, or beyond a wall",
                where_ + ".region",
                "closed walls are solids: to fill one, give a region of type 'inside' with its name");
}

// Closed walls are solids, but for those around the whole region.
void Room::find_solids(const scene::Scene& scene, const std::vector<NamedMesh>& meshes,
                       std::string_view container) {
  for (const scene::Wall& wall : scene.dem->walls) {
    if (wall.name == container) continue;
    const Pose pose = room::pose_of(wall, scene);
    if (const auto* plane = std::get_if<scene::PlaneShape>(&wall.shape)) {
      planes_.push_back({frame_.local(pose.p_WB + pose.q_WB.rotate(plane->point)),
                         frame_.to_world.transpose_times(pose.q_WB.rotate(plane->normal))});
      continue;
    }
    TriangleMesh mesh = room::closed_mesh(wall, meshes);
    if (mesh.triangles.empty() || room::has_open_faces(wall)) continue;
    mesh = room::placed(std::move(mesh), pose, frame_);
    if (lowest_open_edge(mesh) < infinite) continue;
    VerticalCrossings solid(std::move(mesh));
    const auto* above = std::get_if<scene::AboveWall>(&region_);
    if ((above && wall.name == above->wall) || !is_around_region(solid)) solids_.push_back(std::move(solid));
  }
}

bool Room::is_around_region(const VerticalCrossings& solid) const {
  constexpr double tiny = 1e-6;
  const std::vector<Vec3d>& vertices = boundary_->mesh().vertices;
  if (!std::holds_alternative<scene::AboveWall>(region_)) {
    const Vec3d middle = 0.5 * (boundary_->low() + boundary_->high());
    return std::ranges::all_of(vertices, [&](Vec3d vertex) {
      return vertex.z > high_.z || solid.is_inside(vertex + tiny * (middle - vertex));
    });
  }
  // The lowest and the highest point of the room at each corner of the wall, and at those of the rectangle.
  std::vector<Vec3d> corners{low_, high_, {low_.x, high_.y, 0}, {high_.x, low_.y, 0}};
  corners.insert(corners.end(), vertices.begin(), vertices.end());
  const Vec3d middle = 0.5 * (low_ + high_);
  bool is_any = false;
  for (const Vec3d& corner : corners) {
    const double at_x = std::clamp(corner.x, low_.x, high_.x), at_y = std::clamp(corner.y, low_.y, high_.y);
    const double x = at_x + tiny * (middle.x - at_x), y = at_y + tiny * (middle.y - at_y);
    const double low = ground(x, y), high = std::min(top(x, y), high_.z);
    if (!std::isfinite(low) || !(low < high)) continue;
    is_any = true;
    for (const double part : {tiny, 1 - tiny})
      if (!solid.is_inside({x, y, low + part * (high - low)})) return false;
  }
  return is_any;
}

double Room::ground(double x, double y) const {
  double highest = -infinite;
  boundary_->for_crossings(x, y, [&](double z) { highest = std::max(highest, z); });
  return highest;
}

double Room::top(double x, double y) const {
  const std::optional<double>& height = std::get<scene::AboveWall>(region_).height;
  return height ? ground(x, y) + *height : high_.z;
}

bool Room::in_region(Vec3d p) const {
  if (std::holds_alternative<scene::AboveWall>(region_)) {
    if (p.x < low_.x || p.x > high_.x || p.y < low_.y || p.y > high_.y) return false;
    const double below = ground(p.x, p.y);
    return std::isfinite(below) && p.z > below && p.z < top(p.x, p.y) && p.z <= high_.z;
  }
  return p.z <= high_.z && boundary_->is_inside(p);
}

bool Room::holds(Vec3d p) const {
  if (!in_region(p)) return false;
  for (const scene::PlaneShape& plane : planes_)
    if (dot(plane.normal, p - plane.point) < 0) return false;
  for (const VerticalCrossings& solid : solids_)
    if (solid.is_inside(p)) return false;
  return true;
}

void Room::make_columns(ThreadPool& pool) {
  const double width = high_.x - low_.x, depth = high_.y - low_.y;
  constexpr std::size_t all = std::size_t{columns_along} * columns_along;
  column_area_ = width * depth / static_cast<double>(all);
  std::vector<std::vector<Interval>> parts(pool.size());
  for_ranges(pool, all, [&](unsigned thread, std::size_t first, std::size_t end) {
    std::vector<double> cuts;
    for (std::size_t k = first; k < end; ++k) {
      const double x = low_.x + (static_cast<double>(k % columns_along) + 0.5) / columns_along * width,
                   y = low_.y + (static_cast<double>(k / columns_along) + 0.5) / columns_along * depth;
      cuts.assign({low_.z, high_.z});
      boundary_->for_crossings(x, y, [&](double z) { cuts.push_back(z); });
      if (std::holds_alternative<scene::AboveWall>(region_) && std::isfinite(top(x, y)))
        cuts.push_back(top(x, y));
      for (const VerticalCrossings& solid : solids_)
        solid.for_crossings(x, y, [&](double z) { cuts.push_back(z); });
      for (const scene::PlaneShape& plane : planes_)
        if (plane.normal.z != 0)
          cuts.push_back(plane.point.z -
                         (plane.normal.x * (x - plane.point.x) + plane.normal.y * (y - plane.point.y)) /
                             plane.normal.z);
      std::sort(cuts.begin(), cuts.end());
      for (std::size_t c = 0; c + 1 < cuts.size(); ++c)
        if (cuts[c + 1] > cuts[c] && holds({x, y, 0.5 * (cuts[c] + cuts[c + 1])}))
          parts[thread].push_back({cuts[c], cuts[c + 1]});
    }
  });
  for (const std::vector<Interval>& part : parts)
    intervals_.insert(intervals_.end(), part.begin(), part.end());
}

double Room::volume_below(double height) const {
  double sum = 0;
  for (const Interval& part : intervals_) sum += std::max(0.0, std::min(part.high, height) - part.low);
  return sum * column_area_;
}

double Room::height_of(double volume) const {
  double low = low_.z, high = high_.z;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (volume_below(middle) < volume ? low : high) = middle;
  }
  return high;
}

template <class F>
void Room::for_walls(Vec3d world, double radius, F f) const {
  for (std::size_t body = 0; body < surface_.grids.size(); ++body) {
    const Pose& pose = poses_[body];
    const Vec3d centre = pose.q_WB.conjugate().rotate(world - pose.p_WB);
    const NearFacets near =
        near_facets(surface_.grids[body], surface_.cell_start.data(), surface_.cell_facet.data(), centre);
    WallContact contact;
    for (int k = 0; k < near.count; ++k)
      if (touch_facet(surface_.facets.data(), near[k], centre, radius, contact))
        f(-contact.gap, pose.q_WB.rotate(contact.normal));
  }
}

// Distance by which a sphere may exceed a boundary by rounding, relative to its radius.
constexpr double rounding = 1e-9;

bool Room::overlaps(Vec3d p, double radius) const {
  const Vec3d inside = into_region(p, (1 - rounding) * radius);
  if (!(inside == p)) return true;
  bool touched = false;
  for_walls(frame_.world(p), (1 - rounding) * radius, [&](double, Vec3d) { touched = true; });
  return touched || !holds(p);
}

Vec3d Room::into_region(Vec3d p, double radius) const {
  if (p.z > high_.z - radius) p.z = high_.z - radius;
  if (const auto* box = std::get_if<scene::Box>(&region_)) {
    const Vec3d world = frame_.world(p);
    Vec3d inside = world;
    for (int a = 0; a < 3; ++a)
      inside[a] = std::max(box->min[a] + radius, std::min(box->max[a] - radius, world[a]));
    if (!(inside == world)) p = frame_.local(inside);
  } else if (const auto* cylinder = std::get_if<scene::CylinderRegion>(&region_)) {
    const Vec3d axis = cylinder->to - cylinder->from, z = normalized(axis), world = frame_.world(p),
                from_end = world - cylinder->from;
    const double along = dot(from_end, z), half = norm(axis);
    const Vec3d radial = from_end - along * z;
    const double rho = norm(radial), most = cylinder->radius - radius;
    const double inside = std::max(radius, std::min(half - radius, along));
    if (rho > most || inside != along)
      p = frame_.local(cylinder->from + inside * z + (rho > most ? most / rho : 1.0) * radial);
  } else if (std::holds_alternative<scene::AboveWall>(region_)) {
    p.x = std::max(low_.x + radius, std::min(high_.x - radius, p.x));
    p.y = std::max(low_.y + radius, std::min(high_.y - radius, p.y));
    if (!outline_.is_box()) p = outline_.moved_inside(p, radius, std::isfinite(ground(p.x, p.y)));
    if (const double limit = top(p.x, p.y); std::isfinite(limit)) p.z = std::min(p.z, limit - radius);
  } else if (std::holds_alternative<scene::BetweenWalls>(region_)) {
    for (const scene::PlaneShape& face : faces_)
      if (const double beyond = dot(face.normal, p - face.point) + radius; beyond > 0)
        p = p - beyond * face.normal;
  }
  return p;
}

// Out of the deepest wall, then into the region. `again`: it was in a wall, and may be in another one now.
Vec3d Room::moved_once(Vec3d p, double radius, bool& again) const {
  double deepest = 0;
  Vec3d out;
  for_walls(frame_.world(p), radius, [&](double overlap, Vec3d normal) {
    if (overlap > deepest) deepest = overlap, out = overlap * normal;
  });
  again = deepest > 0.5 * rounding * radius;
  if (deepest > 0) p += frame_.to_world.transpose_times(out);
  return into_region(p, radius);
}

Vec3d Room::moved_inside(Vec3d p, double radius) const {
  for (int round = 0; round < 10; ++round) {
    bool again = false;
    const Vec3d once = moved_once(p, radius, again);
    if (!again) return once;
    const Vec3d twice = moved_once(once, radius, again), first = once - p, second = twice - once;
    p = twice;
    if (!again) return p;
    // In a wedge between wall and region the moves have one direction, and get smaller by one factor each:
    // their sum is known.
    const double a = norm(first), b = norm(second);
    if (!(b < a) || dot(first, second) < 0.9 * a * b) continue;
    Vec3d rest = std::min(b / (a - b), 50.0) * second;
    if (const double length = norm(rest); length > radius) rest *= radius / length;
    p = into_region(p + rest, radius);
  }
  return p;
}

}  // namespace tandem::particles
