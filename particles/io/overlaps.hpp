// Overlaps of the spheres of a fill with each other and with walls.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "particles/geometry/analytic_facets.hpp"
#include "particles/geometry/facet_contact.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/io/fill.hpp"

namespace tandem::particles {

// Spheres in cells with the edge of the median diameter. Each sphere searches those not larger than itself,
// so that a few large spheres among many small ones stay cheap. Cells are a sorted list, because the domain
// may be far larger than the fill.
class SphereCells {
 public:
  SphereCells(const Fill& fill, const Periods& periods) : fill_(fill) {
    for (int a = 0; a < 3; ++a) {
      if (periods.length[a] == 0) continue;
      for (std::size_t k = 0, known = shifts_.size(); k < known; ++k)
        for (const int sign : {-1, 1}) {
          shifts_.push_back(shifts_[k]);
          shifts_.back()[a] = sign * periods.length[a];
        }
    }
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

  // Calls f(j, shift) for all spheres j that may touch i and are smaller, or of equal size with a higher
  // index. The shift, whole periods, moves sphere i next to j [m].
  template <class F>
  void for_partners(std::size_t i, F f) const {
    const double reach = 2 * fill_.radius[i];
    for (const Vec3d& shift : shifts_) {
      const Vec3d p = fill_.position[i] + shift;
      bool near = true;
      for (int a = 0; a < 3; ++a)
        near = near && (shift[a] == 0 || (p[a] + reach >= low_[a] && p[a] - reach <= high_[a]));
      if (near) for_partners_at(p, i, [&](std::size_t j) { f(j, shift); });
    }
  }

 private:
  // For sphere i at p.
  template <class F>
  void for_partners_at(Vec3d p, std::size_t i, F f) const {
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

  using Entry = std::pair<std::uint64_t, std::size_t>;  // key, sphere

  // Positions beyond the fill belong to its outermost cell.
  std::uint64_t cell(double x, int a) const {
    return static_cast<std::uint64_t>((std::clamp(x, low_[a], high_[a]) - low_[a]) / edge_);
  }
  static std::uint64_t key(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
    return z << 42 | y << 21 | x;
  }

  const Fill& fill_;
  std::vector<Vec3d> shifts_{{}};  // to a sphere's images; the first is zero [m]
  double edge_ = 0;                // [m]
  Vec3d low_, high_;
  std::vector<Entry> cells_;  // ascending
};

// Error{scene} for a sphere with a value that is not finite or a radius that is not positive, or outside the
// domain.
void check_numbers(const Fill& fill, const scene::Dem& dem);

inline Pose start_pose(BodyId body, const scene::Scene& scene) {
  return body == ground ? Pose{} : scene.mbd.value().bodies.at(body.value).pose;
}

// Calls f(contact, normal, ratio) for every facet of this body's walls that sphere i overlaps. `normal`
// points from the wall to the sphere, world axes; `ratio` is that of the overlap to the smaller radius.
template <class F>
void for_wall_overlaps(const Fill& fill, std::size_t i, const Surface& surface, std::size_t body,
                       const Pose& pose, F f) {
  const Vec3d centre = pose.q_WB.conjugate().rotate(fill.position[i] - pose.p_WB);
  const NearFacets near =
      near_facets(surface.grids[body], surface.cell_start.data(), surface.cell_facet.data(), centre);
  WallContact contact;
  for (int k = 0; k < near.count; ++k)
    if (touch_facet(surface.facets.data(), near[k], centre, fill.radius[i], contact))
      f(contact, pose.q_WB.rotate(contact.normal),
        -contact.gap / smaller_radius(surface.facets[near[k]], fill.radius[i]));
}

}  // namespace tandem::particles
