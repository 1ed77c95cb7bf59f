#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/error.hpp"
#include "dem_server/geometry/facet_contact.hpp"
#include "dem_server/io/fill.hpp"

namespace tandem::dem {
namespace {

[[noreturn]] void fail(const Fill& fill, const scene::Dem& dem, std::size_t sphere,
                       const std::string& problem, const std::string& hint) {
  const std::size_t group = fill.group[sphere];
  throw Error(ErrorCode::scene, problem,
              "dem.particles[" + std::to_string(group) + "] '" + dem.particles[group].name + "'", hint);
}

std::string sphere_at(const Fill& fill, std::size_t i) {
  char text[128];
  const Vec3d p = fill.position[i];
  std::snprintf(text, sizeof text, "sphere %zu at (%.6g, %.6g, %.6g) m", i, p.x, p.y, p.z);
  return text;
}

std::string percent_of_radius(double overlap, double ratio) {
  char text[80];
  std::snprintf(text, sizeof text, "by %.3g m, %.3g %% of the radius", overlap, 100 * ratio);
  return text;
}

// The largest overlap found so far; of equals, the first.
struct Worst {
  double ratio = start_overlap_limit, overlap = 0;
  std::size_t i = 0, j = 0;
  bool found = false;
};

void check_numbers(const Fill& fill, const scene::Dem& dem) {
  for (std::size_t i = 0; i < fill.position.size(); ++i) {
    const Vec3d p = fill.position[i];
    const double r = fill.radius[i];
    if (!is_finite(p) || !is_finite(fill.velocity[i]) || !(r > 0) || !std::isfinite(r)) {
      fail(fill, dem, i, sphere_at(fill, i) + " has a radius, position or velocity that is no number",
           "check its line");
    }
    for (int a = 0; a < 3; ++a) {
      if (p[a] < dem.domain.min[a] || p[a] > dem.domain.max[a]) {
        fail(fill, dem, i, sphere_at(fill, i) + " is outside the domain", "enlarge dem.domain");
      }
    }
  }
}

// Spheres in cells of the median diameter; each looks for those not larger than itself, so that few large
// spheres among many small ones stay cheap. Cells are a sorted list, because the domain may be far larger
// than the fill.
class SphereCells {
 public:
  explicit SphereCells(const Fill& fill) : fill_(fill) {
    std::vector<double> radii = fill.radius;
    const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
    std::nth_element(radii.begin(), middle, radii.end());
    edge_ = 2 * *middle;
    low_ = high_ = fill.position.front();
    for (const Vec3d& p : fill.position) {
      for (int a = 0; a < 3; ++a) {
        low_[a] = std::min(low_[a], p[a]);
        high_[a] = std::max(high_[a], p[a]);
      }
    }
    // A key has 21 bits for each axis.
    for (int a = 0; a < 3; ++a) edge_ = std::max(edge_, (high_[a] - low_[a]) / 2e6);
    cells_.reserve(fill.position.size());
    for (std::size_t i = 0; i < fill.position.size(); ++i) {
      const Vec3d p = fill.position[i];
      cells_.push_back({key(cell(p.x, 0), cell(p.y, 1), cell(p.z, 2)), i});
    }
    std::sort(cells_.begin(), cells_.end());
  }

  // Calls f(j) for all spheres that may touch i and are smaller, or of its size and later.
  template <class F>
  void for_partners(std::size_t i, F f) const {
    const Vec3d p = fill_.position[i];
    const double radius = fill_.radius[i], reach = 2 * radius;
    for (std::uint64_t z = cell(p.z - reach, 2); z <= cell(p.z + reach, 2); ++z) {
      for (std::uint64_t y = cell(p.y - reach, 1); y <= cell(p.y + reach, 1); ++y) {
        const Entry first{key(cell(p.x - reach, 0), y, z), 0}, end{key(cell(p.x + reach, 0) + 1, y, z), 0};
        for (auto c = std::lower_bound(cells_.begin(), cells_.end(), first); c != cells_.end() && *c < end;
             ++c) {
          const std::size_t j = c->second;
          if (fill_.radius[j] < radius || (fill_.radius[j] == radius && j > i)) f(j);
        }
      }
    }
  }

 private:
  using Entry = std::pair<std::uint64_t, std::size_t>;  // key, sphere

  // Beyond the fill: its outermost cell.
  std::uint64_t cell(double x, int a) const {
    return static_cast<std::uint64_t>((std::clamp(x, low_[a], high_[a]) - low_[a]) / edge_);
  }
  static std::uint64_t key(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
    return z << 42 | y << 21 | x;
  }

  const Fill& fill_;
  double edge_ = 0;  // [m]
  Vec3d low_, high_;
  std::vector<Entry> cells_;  // ascending
};

void check_spheres(const Fill& fill, const scene::Dem& dem) {
  const SphereCells cells(fill);
  Worst worst;
  for (std::size_t i = 0; i < fill.position.size(); ++i) {
    cells.for_partners(i, [&](std::size_t j) {
      const double reach = fill.radius[i] + fill.radius[j];
      const double distance2 = norm2(fill.position[i] - fill.position[j]);
      if (distance2 >= reach * reach) return;
      const double overlap = reach - std::sqrt(distance2),
                   ratio = overlap / std::min(fill.radius[i], fill.radius[j]);
      if (ratio > worst.ratio) worst = {ratio, overlap, i, j, true};
    });
  }
  if (!worst.found) return;
  const std::string& other = dem.particles[fill.group[worst.j]].name;
  fail(fill, dem, worst.i,
       sphere_at(fill, worst.i) + " overlaps " + sphere_at(fill, worst.j) + " of '" + other + "' " +
           percent_of_radius(worst.overlap, worst.ratio) + " of the smaller",
       fill.group[worst.i] == fill.group[worst.j] ? "move the spheres apart in the file"
                                                  : "move the fills of the two groups apart");
}

Pose start_pose(BodyId body, const scene::Scene& scene) {
  return body == ground ? Pose{} : scene.mbd.value().bodies.at(body.value).pose;
}

void check_walls(const Fill& fill, const Surface& surface, const scene::Scene& scene) {
  const scene::Dem& dem = scene.dem.value();
  Worst worst;  // i: sphere, j: wall
  for (std::size_t slot = 0; slot < surface.grids.size(); ++slot) {
    const Pose pose = start_pose(surface.slot_body[slot], scene);
    const Quat to_body = pose.q_WB.conjugate();
    for (std::size_t i = 0; i < fill.position.size(); ++i) {
      const Vec3d centre = to_body.rotate(fill.position[i] - pose.p_WB);
      const NearFacets near =
          near_facets(surface.grids[slot], surface.cell_start.data(), surface.cell_facet.data(), centre);
      WallContact contact;
      for (int k = 0; k < near.count; ++k) {
        if (!touch_facet(surface.facets.data(), near[k], centre, fill.radius[i], contact)) continue;
        const double ratio = -contact.gap / fill.radius[i];
        if (ratio > worst.ratio) worst = {ratio, -contact.gap, i, surface.patch_wall[contact.patch], true};
      }
    }
  }
  if (!worst.found) return;
  fail(fill, dem, worst.i,
       sphere_at(fill, worst.i) + " overlaps wall '" + dem.walls[worst.j].name + "' " +
           percent_of_radius(worst.overlap, worst.ratio),
       "move the fill or the wall so that no sphere starts in it");
}

}  // namespace

void check_start(const Fill& fill, const Surface& surface, const scene::Scene& scene) {
  if (fill.position.empty())
    throw Error(ErrorCode::scene, "the fills hold no sphere", "dem.particles", "add a group");
  check_numbers(fill, scene.dem.value());
  check_spheres(fill, scene.dem.value());
  check_walls(fill, surface, scene);
}

}  // namespace tandem::dem
