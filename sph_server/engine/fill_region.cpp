#include "sph_server/engine/fill_region.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "common/geometry/mass_properties.hpp"
#include "common/scene/fault.hpp"
#include "particles/geometry/touch_facet.hpp"
#include "particles/io/random.hpp"
#include "sph_server/equations/hydrostatic.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {
namespace {

[[noreturn]] void refuse(const std::string& what, const std::string& advice) {
  throw Error(ErrorCode::scene, what, "fill", advice);
}

struct Below {
  double volume = 0;  // negative for a mesh whose normals are inwards [m3]
  double depth = 0;   // mean below the level [m]
};

// Sums of tetrahedra whose fourth corner is on the level, so that the cut itself adds nothing.
Below signed_part_below(const TriangleMesh& region, Vec3d up, double level) {
  if (region.vertices.empty()) return {};
  const Vec3d first = region.vertices.front(), origin = first + (level - dot(first, up)) * up;
  double volume = 0, moment = 0;
  for (const auto& t : region.triangles) {
    Vec3d kept[4];
    int count = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3d a = region.vertices[t[k]] - origin, b = region.vertices[t[(k + 1) % 3]] - origin;
      const double at_a = dot(a, up), at_b = dot(b, up);
      if (at_a <= 0) kept[count++] = a;
      if ((at_a < 0 && at_b > 0) || (at_a > 0 && at_b < 0))
        kept[count++] = a + (at_a / (at_a - at_b)) * (b - a);
    }
    for (int k = 2; k < count; ++k) {
      const double one = dot(kept[0], cross(kept[k - 1], kept[k])) / 6;
      volume += one;
      moment -= one * dot(kept[0] + kept[k - 1] + kept[k], up) / 4;
    }
  }
  return {volume, volume != 0 ? moment / volume : 0};
}
Below part_below(const TriangleMesh& region, Vec3d up, double level) {
  const Below below = signed_part_below(region, up, level);
  return {std::fabs(below.volume), below.depth};
}

Vec3d upwards(Vec3d gravity) {
  return -1.0 / norm(gravity) * gravity;
}

// Heights of the lowest and of the highest vertex along `up` [m].
std::pair<double, double> extent_along(const TriangleMesh& region, Vec3d up) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec3d& v : region.vertices) {
    low = std::min(low, dot(v, up));
    high = std::max(high, dot(v, up));
  }
  return {low, high};
}

// Where the level is along `up` [m].
double level_of(const TriangleMesh& region, Vec3d up, const FillAmount& amount) {
  const auto [low, high] = extent_along(region, up);
  const double whole = part_below(region, up, high).volume + amount.common;
  if (amount.height) {
    if (!(*amount.height > 0 && *amount.height <= (high - low) * (1 + 1e-9)))
      refuse("a height of " + scene::rounded(*amount.height) + " m in a region that is " +
                 scene::rounded(high - low) + " m high",
             "give a height above 0 and of at most that of the region");
    return low + *amount.height;
  }
  if (!(*amount.volume > 0 && *amount.volume <= whole * (1 + 1e-9)))
    refuse("a volume of " + scene::rounded(*amount.volume) + " m3 in a region of " + scene::rounded(whole) +
               " m3",
           "give a volume above 0 and of at most that of the region");
  double lower = low, upper = high;
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (lower + upper);
    (part_below(region, up, middle).volume + amount.common < *amount.volume ? lower : upper) = middle;
  }
  return upper;
}

// The same mesh with its normals outwards.
TriangleMesh outwards(TriangleMesh mesh, Vec3d up, double high) {
  if (signed_part_below(mesh, up, high).volume < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

// Refuses a mesh that is open below the level: each edge there belongs to as many triangles of one direction
// as of the other.
void expect_closed(const TriangleMesh& region, Vec3d up, double level) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  std::map<std::array<double, 3>, std::uint32_t> known;
  std::vector<std::uint32_t> same(region.vertices.size());  // vertices at one place are one
  for (std::uint32_t v = 0; v < region.vertices.size(); ++v) {
    const Vec3d x = region.vertices[v];
    same[v] = known.emplace(std::array{x.x, x.y, x.z}, v).first->second;
  }
  for (const auto& t : region.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = same[t[k]], to = same[t[(k + 1) % 3]];
      balance[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  for (const auto& [edge, sum] : balance) {
    if (sum == 0) continue;
    for (const std::uint32_t v : {edge.first, edge.second})
      if (dot(region.vertices[v], up) < level - 1e-9 * (1 + std::fabs(level)))
        refuse("a region that is not closed: its edge at " + scene::rounded(region.vertices[v]) +
                   " m, below the level, has a triangle on one side only",
               "give a mesh that is closed up to the level");
  }
}

// Axes of the lattice: the third is `up`, the first as near as possible to an axis of the region.
struct Frame {
  Vec3d axis[3];
  Frame(Vec3d up, const Mat3d& axes) {
    int least = 0;
    const Vec3d in_region = axes.transpose_times(up);
    for (int a = 1; a < 3; ++a)
      if (std::fabs(in_region[a]) < std::fabs(in_region[least]) - 1e-9) least = a;
    Vec3d along;
    along[least] = 1;
    along = axes * along;
    axis[0] = normalized(along - dot(along, up) * up);
    axis[1] = cross(up, axis[0]);
    axis[2] = up;
  }
};

struct Site {
  double gap = 0;           // to the nearest wall, in whole millionths of a spacing [m]
  std::uint64_t order = 0;  // among equal gaps
  Vec3d x;
};

class Filler {
 public:
  Filler(const LiquidSetup& setup, const std::vector<particles::BodyPose>& poses, const TriangleMesh& region,
         const FillAmount& amount, const Mat3d& axes)
      : setup_(setup),
        poses_(poses),
        region_(region),
        frame_(upwards(setup.liquid.gravity), axes),
        walls_(setup.walls, setup.liquid.support()) {
    for (std::uint32_t b = 0; b < walls_.bodies(); ++b) walls_.set_pose(b, poses[b]);
    for (int a = 0; a < 3; ++a) {
      low_[a] = std::numeric_limits<double>::infinity();
      high_[a] = -low_[a];
      for (const Vec3d& v : region.vertices) {
        low_[a] = std::min(low_[a], dot(v, frame_.axis[a]));
        high_[a] = std::max(high_[a], dot(v, frame_.axis[a]));
      }
    }
    level_ = level_of(region, up(), amount);
    Below below = part_below(region, up(), level_);
    below.volume += amount.common;
    uncompressed_ =
        static_cast<std::size_t>(std::llround(below.volume * setup.liquid.density / setup.liquid.mass()));
    const Liquid& l = setup.liquid;
    const double wanted = below.volume * l.density / l.mass() * (1 + at_rest(l, below.depth).compression);
    wanted_ = static_cast<std::size_t>(std::llround(wanted));
    if (wanted_ == 0)
      refuse("a volume of " + scene::rounded(below.volume) + " m3 below the level",
             "fill more than the volume of a particle, " + scene::rounded(l.mass() / l.density) + " m3");
  }

  LiquidState fill() const {
    LiquidState state;
    const double a = setup_.liquid.spacing;
    const auto lattice = sites(a);
    const bool fits = lattice.size() == uncompressed_ &&
                      std::ranges::all_of(lattice, [&](const Site& s) { return s.gap > 0.49 * a; });
    for (const Site& s : fits ? lattice : packed()) {
      Vec3d x = s.x;
      double depth = level_ - dot(x, up());
      // The layers of a column are closer together where it is compressed.
      if (fits) {
        const double bottom = depth_at_rest(setup_.liquid, level_ - low_[2]);
        depth = depth_at_rest(setup_.liquid, depth);
        x += (low_[2] + bottom - depth - dot(x, up())) * up();
      }
      state.position.push_back(x);
      state.velocity.push_back({});
      state.compression.push_back(at_rest(setup_.liquid, depth).compression);
    }
    return state;
  }

 private:
  Vec3d up() const { return frame_.axis[2]; }

  double gap_at(Vec3d x) const {
    double gap = setup_.liquid.support();
    NearWalls near;
    walls_.find(x, setup_.liquid.support(), near);
    for (int k = 0; k < near.count; ++k) {
      const NearFacet& f = near.facet[k];
      particles::WallContact contact;
      const particles::Facet facet{f.a, f.b, f.c, f.normal};
      const double R = setup_.liquid.support();
      if (particles::touch_triangle(facet, x, R, contact)) gap = std::min(gap, contact.gap + R);
    }
    return gap;
  }

  // Sites of a cubic lattice of spacing a in the region and below the level, those furthest from walls first.
  // The first layers are half a spacing from the bounds of the region; layers are evenly spaced up to the
  // level.
  std::vector<Site> sites(double a) const {
    std::vector<Site> found;
    particles::Random random(1);
    std::int64_t n[3];
    for (int k = 0; k < 2; ++k) n[k] = static_cast<std::int64_t>(std::ceil((high_[k] - low_[k]) / a));
    n[2] = std::max(std::int64_t{1}, static_cast<std::int64_t>(std::llround((level_ - low_[2]) / a)));
    const double edge[3] = {a, a, (level_ - low_[2]) / static_cast<double>(n[2])};
    for (std::int64_t z = 0; z < n[2]; ++z)
      for (std::int64_t y = 0; y < n[1]; ++y)
        for (std::int64_t x = 0; x < n[0]; ++x) {
          Vec3d at;
          const std::int64_t index[3] = {x, y, z};
          for (int k = 0; k < 3; ++k)
            at += (low_[k] + (static_cast<double>(index[k]) + 0.5) * edge[k]) * frame_.axis[k];
          if (winding_number(region_, at) < 0.5) continue;
          // Sites of equal gaps are left out here and there, not layer by layer.
          const double quantum = 1e-6 * setup_.liquid.spacing;
          found.push_back({quantum * std::nearbyint(gap_at(at) / quantum), random.bits(), at});
        }
    std::ranges::sort(found, [](const Site& p, const Site& q) {
      return p.gap != q.gap ? p.gap > q.gap : p.order < q.order;
    });
    return found;
  }

  std::vector<Site> packed() const {
    const Liquid& l = setup_.liquid;
    std::vector<Site> start;
    // The lattice of which fewest sites have to be left out: what lacks beside walls or below the level has
    // to be filled by motion.
    for (double part = 1.05; part > 0.5 && (start.size() < wanted_ || part > 0.9); part -= 0.01) {
      std::vector<Site> found = sites(part * l.spacing);
      if (found.size() >= wanted_ && (start.size() < wanted_ || found.size() < start.size()))
        start = std::move(found);
    }
    if (start.size() < wanted_)
      refuse("a region that is narrower than a spacing of the liquid", "take a smaller spacing");
    start.resize(wanted_);
    LiquidSetup packing = setup_;
    packing.liquid.shifting = 0;
    packing.walls.push_back(lid());
    std::vector<particles::BodyPose> poses = poses_;
    // The liquid is packed at rest in walls at rest.
    for (particles::BodyPose& pose : poses) pose.v = pose.w = {};
    poses.push_back({{}, Mat3d::identity(), {}, {}});
    LiquidState state;
    for (const Site& s : start) {
      state.position.push_back(s.x);
      state.velocity.push_back({});
      state.compression.push_back(at_rest(l, level_ - dot(s.x, up())).compression);
    }
    const auto engine = make_liquid_engine(packing, true);
    engine->set_state(state, poses);
    // As high as the step allows: the time to come to rest falls with it.
    const double dt = step_limits(l, l.sound_speed, 0).smallest,
                 pressure = 0.04 * l.density * l.sound_speed * l.sound_speed;
    // What remains of the forces, divided by those of a surface without a lid [-].
    constexpr double at_rest_below = 0.005;
    constexpr int chunk = 50, most = 2000;
    for (int steps = 0; steps < most; steps += chunk) {
      engine->pack(pressure, dt, 0.95, chunk);
      if (engine->figures().largest_acceleration < at_rest_below * pressure / (l.density * l.spacing)) break;
    }
    if (engine->figures().passed_walls > 0)
      refuse(std::to_string(engine->figures().passed_walls) +
                 " particles left the region while they were packed",
             "close the walls around the liquid, or take a smaller spacing");
    state = engine->state();
    for (std::size_t i = 0; i < start.size(); ++i) start[i].x = state.position[i];
    return start;
  }

  // A rectangle at the level that covers the region.
  TriangleMesh lid() const {
    const double more = 2 * setup_.liquid.support();
    TriangleMesh mesh;
    for (const auto& [x, y] :
         {std::pair{low_[0] - more, low_[1] - more}, std::pair{high_[0] + more, low_[1] - more},
          std::pair{high_[0] + more, high_[1] + more}, std::pair{low_[0] - more, high_[1] + more}})
      mesh.vertices.push_back(x * frame_.axis[0] + y * frame_.axis[1] + level_ * up());
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
  }

  const LiquidSetup& setup_;
  const std::vector<particles::BodyPose>& poses_;
  const TriangleMesh& region_;
  Frame frame_;
  Walls walls_;
  double low_[3]{}, high_[3]{};   // bounds of the region along the axes of the lattice [m]
  double level_ = 0;              // along `up` [m]
  std::size_t wanted_ = 0;        // particles
  std::size_t uncompressed_ = 0;  // the same in a lattice that is not compressed
};

}  // namespace

double volume_below(const TriangleMesh& region, Vec3d up, double level) {
  return part_below(region, up, level).volume;
}

double depth_of(const TriangleMesh& region, Vec3d gravity, const FillAmount& amount) {
  if (!(norm(gravity) > 0))
    refuse("a level without gravity", "give gravity, or place the particles otherwise");
  if (amount.height.has_value() == amount.volume.has_value())
    refuse("neither or both of height and volume", "give one of them");
  const Vec3d up = upwards(gravity);
  const double level = level_of(region, up, amount);
  expect_closed(region, up, level);
  return level - extent_along(region, up).first;
}

LiquidState fill_region(const LiquidSetup& setup, const std::vector<particles::BodyPose>& poses,
                        const TriangleMesh& region, const FillAmount& amount, const Mat3d& axes) {
  expect_liquid(setup.liquid);
  depth_of(region, setup.liquid.gravity, amount);
  const Vec3d up = upwards(setup.liquid.gravity);
  const TriangleMesh oriented = outwards(region, up, extent_along(region, up).second);
  return Filler(setup, poses, oriented, amount, axes).fill();
}

}  // namespace tandem::sph
