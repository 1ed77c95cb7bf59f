#include "sph_server/io/rest_loads.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "sph_server/equations/state.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {
namespace {

// Particles by cells of `edge` [m].
class Cells {
 public:
  Cells(const std::vector<Vec3d>& x, double edge) : x_(x), edge_(edge) {
    for (std::uint32_t i = 0; i < x.size(); ++i) cells_[key(of(x[i]))].push_back(i);
  }
  template <class Each>
  void for_near(Vec3d x, Each each) const {
    const auto at = of(x);
    for (std::int64_t n = 0; n < 27; ++n) {
      const auto found = cells_.find(key({at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1}));
      if (found == cells_.end()) continue;
      for (const std::uint32_t i : found->second)
        if (norm2(x_[i] - x) < edge_ * edge_) each(i);
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell of(Vec3d x) const {
    Cell cell;
    for (int a = 0; a < 3; ++a)
      cell[static_cast<std::size_t>(a)] = static_cast<std::int64_t>(std::floor(x[a] / edge_));
    return cell;
  }
  static std::int64_t key(const Cell& c) {
    constexpr std::int64_t half = 1 << 20, most = 2 * half;
    return ((c[2] + half) * most + c[1] + half) * most + c[0] + half;
  }
  const std::vector<Vec3d>& x_;
  double edge_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cells_;
};

// Calls each(middle, area) for the parts of a triangle, whose edges are at most `longest` [m].
template <class Each>
void for_parts(Vec3d a, Vec3d b, Vec3d c, double longest, Each each) {
  const double edge = std::max({norm(b - a), norm(c - b), norm(a - c)});
  const int n = std::max(1, static_cast<int>(std::ceil(edge / longest)));
  const double area = 0.5 * norm(cross(b - a, c - a)) / (n * n);
  const auto at = [&](double i, double j) { return a + (i / n) * (b - a) + (j / n) * (c - a); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      each(at(i + 1.0 / 3, j + 1.0 / 3), area);
      if (i + j + 1 < n) each(at(i + 2.0 / 3, j + 2.0 / 3), area);
    }
}

class Pressures {
 public:
  Pressures(const LiquidState& liquid, const LiquidSetup& setup,
            const std::vector<particles::BodyPose>& poses)
      : liquid_(liquid),
        properties_(setup.liquid),
        walls_(setup.walls, setup.liquid.support()),
        cells_(liquid.position, reach * setup.liquid.spacing) {
    for (std::uint32_t b = 0; b < walls_.bodies(); ++b) walls_.set_pose(b, poses[b]);
  }

  // At a point of a wall, on the side to which n points [Pa]; 0 where there is no liquid.
  double on(Vec3d x, Vec3d n) const {
    const double spacing = properties_.spacing;
    const Vec3d before = x + 1e-3 * spacing * n;
    double nearest = 1e300, pressure = 0;
    cells_.for_near(x, [&](std::uint32_t i) {
      const Vec3d to = liquid_.position[i] - x;
      if (dot(to, n) <= 0 || norm2(to) >= nearest || walls_.view().between(before, liquid_.position[i]))
        return;
      nearest = norm2(to);
      const double c2 = properties_.sound_speed * properties_.sound_speed;
      pressure =
          properties_.density * (c2 * tait_pressure(liquid_.compression[i]) - dot(properties_.gravity, to));
    });
    return std::max(0.0, pressure);
  }

 private:
  static constexpr double reach = 1.5;  // of the nearest particle [spacings]
  const LiquidState& liquid_;
  const Liquid& properties_;
  Walls walls_;
  Cells cells_;
};

}  // namespace

std::map<BodyId, Wrench> loads_at_rest(const LiquidState& liquid, const std::vector<BodyWalls>& walls,
                                       const LiquidSetup& setup,
                                       const std::vector<particles::BodyPose>& poses, BodyId vessel) {
  std::map<BodyId, Wrench> loads;
  std::map<BodyId, Vec3d> centre;
  const Pressures pressures(liquid, setup, poses);
  Wrench left;  // of the weight of the liquid, about the origin
  for (const Vec3d& x : liquid.position) {
    left.force += setup.liquid.mass() * setup.liquid.gravity;
    left.torque += cross(x, setup.liquid.mass() * setup.liquid.gravity);
  }
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const BodyId body = walls[w].body;
    if (body != ground) {
      loads.try_emplace(body);
      centre[body] = poses[w].p;
    }
    if (body == vessel) continue;
    const TriangleMesh& mesh = setup.walls[w];
    for (const auto& t : mesh.triangles) {
      const auto at = [&](std::uint32_t v) { return poses[w].p + poses[w].R * mesh.vertices[v]; };
      const Vec3d a = at(t[0]), b = at(t[1]), c = at(t[2]), across = cross(b - a, c - a);
      if (norm(across) == 0) continue;
      const Vec3d n = normalized(across);
      for_parts(a, b, c, 0.5 * setup.liquid.spacing, [&](Vec3d x, double area) {
        const Vec3d force = (area * (pressures.on(x, -n) - pressures.on(x, n))) * n;
        left.force -= force;
        left.torque -= cross(x, force);
        if (body == ground) return;
        loads[body].force += force;
        loads[body].torque += cross(x - poses[w].p, force);
      });
    }
  }
  if (vessel != ground) loads[vessel] = {left.force, left.torque - cross(centre[vessel], left.force)};
  return loads;
}

}  // namespace tandem::sph
