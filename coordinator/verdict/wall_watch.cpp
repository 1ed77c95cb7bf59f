#include "coordinator/verdict/wall_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace tandem::launch {
namespace {

constexpr double rim_share = 1.5;    // share of the tolerance by which rims of two open surfaces shrink [-]
constexpr double moved_share = 0.1;  // relative motion, as a share of the thinner wall's thickness, after
                                     // which a pair is checked again [-]
constexpr std::size_t most_pairs = 5000;         // more would increase the run time noticeably
constexpr std::size_t most_triangles = 100'000;  // of a mesh; more would increase the start time noticeably
// Tests of an edge against a triangle, some nanoseconds each: at most 20 us per window on average.
constexpr double tests_per_call = 5000, most_tests = 3e7;
// Additional cost of a pair and of each of its triangles: transformation of points, bounding boxes.
constexpr double tests_per_pair = 300, tests_per_triangle = 10;

Vec3d to_world(const Pose& X, Vec3d p) {
  return X.p_WB + X.q_WB.rotate(p);
}
Pose relative(const Pose& a, const Pose& b) {
  const Quat to_b = b.q_WB.conjugate();
  return {to_b.rotate(a.p_WB - b.p_WB), to_b * a.q_WB};
}

Pose inverse(const Pose& X) {
  const Quat back = X.q_WB.conjugate();
  return {-back.rotate(X.p_WB), back};
}

// Intersection of an edge and a triangle.
struct Hit {
  double at = 0;   // along the edge, 0 to 1
  double way = 0;  // signed extent of the whole edge along the triangle's normal [m]
};

// Intersects the edge from p to q with triangle t. None next to a sharp edge of the surface, where the
// surfaces are in contact.
std::optional<Hit> hit(Vec3d p, Vec3d q, const WallSurface& surface, const std::vector<Vec3d>& points,
                       std::size_t t, double margin) {
  const auto& corner = surface.mesh.triangles[t];
  const Vec3d a = points[corner[0]], n = cross(points[corner[1]] - a, points[corner[2]] - a);
  const double size = norm(n), at_p = dot(n, p - a) / size, at_q = dot(n, q - a) / size;
  if (!(at_p * at_q < 0)) return {};
  const double at = at_p / (at_p - at_q);
  const Vec3d x = p + at * (q - p);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d from = points[corner[k]], side = points[corner[(k + 1) % 3]] - from;
    const double inside = dot(n, cross(side, x - from)) / (size * norm(side));  // distance from this side [m]
    // At the side that two triangles share, rounding must not put the point outside both.
    if (inside < (surface.sharp[t][k] ? margin : 0) - 1e-9 * norm(side)) return {};
  }
  return Hit{at, at_q - at_p};
}

// Depth by which an edge with these hits extends beyond the surface that it crosses: for each hit the smaller
// of two distances, across the triangle, to the hit before and to the next one [m]. An edge that grazes a
// round surface enters and leaves it at almost the same place.
double depth_of(std::vector<Hit>& hits) {
  std::sort(hits.begin(), hits.end(), [](const Hit& x, const Hit& y) { return x.at < y.at; });
  // An edge through the side that two triangles share has two hits in the same direction.
  const auto same = [](const Hit& x, const Hit& y) { return y.at - x.at < 1e-7 && x.way * y.way > 0; };
  hits.erase(std::unique(hits.begin(), hits.end(), same), hits.end());
  double depth = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const double before = hits[i].at - (i == 0 ? 0 : hits[i - 1].at),
                 after = (i + 1 == hits.size() ? 1 : hits[i + 1].at) - hits[i].at;
    depth = std::max(depth, std::min(before, after) * std::abs(hits[i].way));
  }
  return depth;
}

// The shortest displacement along an axis that separates two boxes [m]: edges may extend further beyond a
// surface than that.
double way_apart(const Bounds& a, const Bounds& b) {
  double way = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) way = std::min({way, a.high[i] - b.low[i], b.high[i] - a.low[i]});
  return way;
}

// Points of a surface shrunk by `by` [m], in the target frame of `pose`.
std::vector<Vec3d> shrunk(const WallSurface& s, double by, const Pose& pose) {
  std::vector<Vec3d> points;
  points.reserve(s.mesh.vertices.size());
  for (std::size_t i = 0; i < s.mesh.vertices.size(); ++i)
    points.push_back(to_world(pose, s.mesh.vertices[i] + by * s.shrink[i]));
  return points;
}

// Crossings of the edges of one surface, with its points at `points`, with triangles of another, with its
// points at `others`: all in one frame. Hits within `margin` [m] of sharp edges of the other are ignored.
struct Crossing {
  double depth = 0;  // [m]
  double tests = 0;  // number of tests, or the number needed if more than `most_tests`
};
Crossing edges_through(const WallSurface& one, const std::vector<Vec3d>& points, const WallSurface& other,
                       const std::vector<Vec3d>& others, double margin) {
  const auto bounds = [](const std::vector<Vec3d>& all, const auto& indices) {
    Bounds box;
    for (const std::uint32_t v : indices) box.add(all[v]);
    return box;
  };
  const Bounds around = bounds_of(points), around_other = bounds_of(others);
  std::vector<std::pair<Bounds, std::size_t>> near;
  for (std::size_t t = 0; t < other.mesh.triangles.size(); ++t)
    if (const Bounds b = bounds(others, other.mesh.triangles[t]); b.overlaps(around)) near.emplace_back(b, t);
  std::vector<std::pair<Bounds, std::array<std::uint32_t, 2>>> edges;
  for (const auto& edge : one.edges)
    if (const Bounds b = bounds(points, edge); b.overlaps(around_other)) edges.emplace_back(b, edge);
  Crossing result;
  result.tests = static_cast<double>(edges.size()) * static_cast<double>(near.size());
  if (result.tests > most_tests) return result;
  std::vector<Hit> hits;
  for (const auto& [of_edge, edge] : edges) {
    hits.clear();
    for (const auto& [of_triangle, t] : near)
      if (of_edge.overlaps(of_triangle))
        if (const auto found = hit(points[edge[0]], points[edge[1]], other, others, t, margin))
          hits.push_back(*found);
    result.depth = std::max(result.depth, depth_of(hits));
  }
  return result;
}

// Index of the group of welded bodies; the ground has the index `bodies`.
std::vector<std::size_t> weld(const scene::Mbd& mbd) {
  std::vector<std::size_t> group(mbd.bodies.size() + 1);
  std::iota(group.begin(), group.end(), 0);
  const auto index = [&](BodyId id) { return id == ground ? mbd.bodies.size() : id.value; };
  for (const scene::Joint& joint : mbd.joints) {
    if (joint.type != scene::JointType::fixed) continue;
    const std::size_t from = group[index(joint.child)], to = group[index(joint.parent)];
    std::replace(group.begin(), group.end(), from, to);
  }
  return group;
}

std::string quoted(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < 5; ++i)
    text += fmt::format("{}'{}'", i == 0 ? "" : ", ", names[i]);
  return names.size() > 5 ? text + fmt::format(" and {} more", names.size() - 5) : text;
}

}  // namespace

WallWatch::WallWatch(const scene::Scene& scene, const std::vector<NamedMesh>& meshes)
    : scene_(scene), walls_(scene.walls()) {
  if (!scene.mbd) return;
  std::vector<std::string> bare;
  for (std::uint32_t i = 0; i < scene.mbd->bodies.size(); ++i) {
    const bool has_walls =
        std::ranges::any_of(walls_, [&](const scene::Wall& wall) { return wall.body == BodyId{i}; });
    // Shapes of contact push each other apart, and end the run where they do not
    // (mbd_server/step/body_contacts.cpp).
    const bool touches = scene.contact && std::ranges::any_of(scene.shapes, [&](const scene::Shape& shape) {
                           return shape.use == scene::ShapeUse::contact && shape.body == BodyId{i};
                         });
    if (!has_walls && !touches) bare.push_back(scene.mbd->bodies[i].name);
  }
  if (!bare.empty())
    not_judged_.push_back(
        fmt::format("whether bodies pass through others: {} without walls ({}) {} no known shape",
                    bare.size() == 1 ? "1 body" : fmt::format("{} bodies", bare.size()), quoted(bare),
                    bare.size() == 1 ? "has" : "have"));
  if (walls_.empty() || bare.size() == scene.mbd->bodies.size()) return;
  group_ = weld(*scene.mbd);
  const std::vector<const scene::Wall*> walls = walls_to_judge(meshes);
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < walls.size(); ++i)
    for (std::size_t j = 0; j < i && pairs <= most_pairs; ++j) pairs += walls[i]->body != walls[j]->body;
  if (pairs > most_pairs) {
    not_judged_.push_back(fmt::format(
        "whether bodies pass through others: there are more than {} pairs of walls of different bodies",
        most_pairs));
    return;
  }
  for (const scene::Wall* wall : walls) surfaces_.push_back(make_surface(*wall, scene, meshes));
  make_pairs();
}

std::vector<const scene::Wall*> WallWatch::walls_to_judge(const std::vector<NamedMesh>& meshes) {
  std::vector<const scene::Wall*> walls;
  std::vector<std::string> fine;
  for (const scene::Wall& wall : walls_) {
    const auto named = std::find_if(meshes.begin(), meshes.end(),
                                    [&](const NamedMesh& mesh) { return mesh.name == wall.name; });
    if (named != meshes.end() && named->mesh.triangles.size() > most_triangles)
      fine.push_back(wall.name);
    else
      walls.push_back(&wall);
  }
  if (!fine.empty())
    not_judged_.push_back(fmt::format("whether bodies pass through walls of more than {} triangles: {}",
                                      most_triangles, quoted(fine)));
  return walls;
}

std::size_t WallWatch::group_of(BodyId body) const {
  return group_[body == ground ? group_.size() - 1 : body.value];
}

// Whether only the missing contact prevents the two bodies from passing through each other.
bool WallWatch::may_meet(const WallSurface& a, const WallSurface& b) const {
  const scene::Mbd& mbd = *scene_.mbd;
  const std::size_t of_a = group_of(a.wall->body), of_b = group_of(b.wall->body), of_ground = group_.back();
  if (of_a == of_b) return false;
  const WallSurface& on_ground = of_a == of_ground ? a : b;
  for (const scene::Joint& joint : mbd.joints) {
    if (joint.type == scene::JointType::free || joint.type == scene::JointType::distance) continue;
    const std::size_t parent = group_of(joint.parent), child = group_of(joint.child);
    if (!(parent == of_a && child == of_b) && !(parent == of_b && child == of_a)) continue;
    if (of_a != of_ground && of_b != of_ground) return false;
    // The ground is large: only its wall at the joint counts as connected.
    if (on_ground.plane) continue;
    const Pose pose = on_ground.wall->body == ground ? Pose{} : mbd.bodies[on_ground.wall->body.value].pose;
    const Vec3d arm = pose.q_WB.conjugate().rotate(joint.position - pose.p_WB) - on_ground.centre;
    const double slack = std::min(a.thickness, b.thickness);
    if (std::abs(arm.x) <= on_ground.half.x + slack && std::abs(arm.y) <= on_ground.half.y + slack &&
        std::abs(arm.z) <= on_ground.half.z + slack)
      return false;
  }
  return true;
}

void WallWatch::make_pairs() {
  const std::size_t n = surfaces_.size();
  std::vector<std::string> overlapping;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const WallSurface &a = surfaces_[i], &b = surfaces_[j];
      if (a.wall->body == b.wall->body || (a.plane && b.plane) || !may_meet(a, b)) continue;
      Pair pair;
      pair.a = a.plane ? j : i;
      pair.b = a.plane ? i : j;
      pair.thickness = std::min(a.thickness, b.thickness);
      pair.last =
          relative(pose_of(surfaces_[pair.a].wall->body, {}), pose_of(surfaces_[pair.b].wall->body, {}));
      if (!b.plane && !a.plane) {
        const Pose b_in_a = inverse(pair.last);
        pair.hollow_a = a.closed && is_inside(to_world(b_in_a, b.mesh.vertices.front()), a, a.mesh.vertices);
        pair.hollow_b =
            b.closed && is_inside(to_world(pair.last, a.mesh.vertices.front()), b, b.mesh.vertices);
      }
      if (is_near(pair, pair.last) && depth(pair, pair.last) > wall_depth_share * pair.thickness)
        overlapping.push_back(a.wall->name + "' and '" + b.wall->name);
      else
        pairs_.push_back(pair);
    }
  if (!overlapping.empty())
    not_judged_.push_back("whether walls pass through each other that overlap in the pose of the scene: " +
                          quoted(overlapping));
  budget_ = 0;  // the start is not limited
}

Pose WallWatch::pose_of(BodyId body, const std::vector<protocol::BodyState>& bodies) const {
  if (body == ground) return {};
  return bodies.empty() ? scene_.mbd->bodies[body.value].pose : bodies[body.value].pose;
}

bool WallWatch::is_near(const Pair& pair, const Pose& a_in_b) const {
  const WallSurface &a = surfaces_[pair.a], &b = surfaces_[pair.b];
  const Vec3d centre = to_world(a_in_b, a.centre);
  if (b.plane) return dot(b.normal, centre - b.point) < a.radius;
  return norm(centre - b.centre) < a.radius + b.radius;
}

double WallWatch::depth(const Pair& pair, const Pose& a_in_b) {
  const WallSurface &a = surfaces_[pair.a], &b = surfaces_[pair.b];
  budget_ -= static_cast<double>(a.mesh.vertices.size());
  if (b.plane) {
    double deepest = 0;
    for (const Vec3d& p : a.mesh.vertices)
      deepest = std::max(deepest, dot(b.normal, b.point - to_world(a_in_b, p)));
    return deepest;
  }
  const double tolerance = wall_depth_share * pair.thickness;
  const bool solid_a = a.closed && !pair.hollow_a, solid_b = b.closed && !pair.hollow_b;
  // The surface that shrinks further is the one to shrink. Where it cannot shrink by the whole tolerance,
  // its edges must extend beyond triangles by the remainder, and keep that distance from sharp edges, but
  // no more than the amount by which it shrinks.
  const bool of_a = solid_a && !(solid_b && b.most_shrink > a.most_shrink);
  const double by = solid_a || solid_b ? std::min(tolerance, (of_a ? a : b).most_shrink) : 0;
  const double margin = by > 0 ? std::min(tolerance - by, 0.9 * by) : tolerance;
  const std::vector<Vec3d> at_a = shrunk(a, of_a ? by : 0, a_in_b), at_b = shrunk(b, of_a ? 0 : by, {});
  Crossing there, back;
  if (by > 0) {
    there = edges_through(a, at_a, b, at_b, margin), back = edges_through(b, at_b, a, at_a, margin);
  } else {
    there = edges_through(a, shrunk(a, a.closed ? 0 : rim_share * tolerance, a_in_b), b, at_b, margin);
    back = edges_through(b, shrunk(b, b.closed ? 0 : rim_share * tolerance, {}), a, at_a, margin);
  }
  budget_ -= tests_per_pair +
             tests_per_triangle * static_cast<double>(a.mesh.triangles.size() + b.mesh.triangles.size()) +
             std::min(most_tests, there.tests + back.tests);
  if (std::max(there.tests, back.tests) > most_tests) {
    const std::string sentence =
        fmt::format("whether walls '{}' and '{}' pass through each other: their meshes are too fine",
                    a.wall->name, b.wall->name);
    if (std::find(not_judged_.begin(), not_judged_.end(), sentence) == not_judged_.end())
      not_judged_.push_back(sentence);
  }
  const double depth = std::max(there.depth, back.depth);
  if (depth > 0) return std::min(depth + by, way_apart(bounds_of(at_a), bounds_of(at_b)) + by);
  // No edge of a surface that is completely inside the other crosses it.
  if (solid_a && is_inside(at_b.front(), a, at_a)) return b.thickness;
  if (solid_b && is_inside(at_a.front(), b, at_b)) return a.thickness;
  return 0;
}

void WallWatch::observe(double time, const std::vector<protocol::BodyState>& bodies, bool last) {
  budget_ = std::min(budget_ + tests_per_call, most_tests);
  for (std::size_t k = 0; k < pairs_.size() && (budget_ > 0 || last); ++k) {
    Pair& pair = pairs_[next_];
    next_ = (next_ + 1) % pairs_.size();
    const WallSurface &a = surfaces_[pair.a], &b = surfaces_[pair.b];
    const Pose a_in_b = relative(pose_of(a.wall->body, bodies), pose_of(b.wall->body, bodies));
    if (!is_near(pair, a_in_b)) continue;
    const double reach = a.radius + norm(a.centre);
    const double moved = norm(a_in_b.p_WB - pair.last.p_WB) +
                         reach * norm(rotation_vector(a_in_b.q_WB * pair.last.q_WB.conjugate()));
    if (moved < (last ? wall_depth_share : moved_share) * pair.thickness) continue;
    pair.last = a_in_b;
    const double depth = this->depth(pair, a_in_b);
    if (!(depth > wall_depth_share * pair.thickness)) continue;
    if (pair.crossing == none) {
      pair.crossing = crossings_.size();
      crossings_.push_back(
          {a.wall->name, scene_.body_name(a.wall->body), b.wall->name, scene_.body_name(b.wall->body), time});
    }
    WallCrossing& crossing = crossings_[pair.crossing];
    crossing.depth = std::max(crossing.depth, depth);
    crossing.share = crossing.depth / pair.thickness;
  }
}

}  // namespace tandem::launch
