// The integrals over what a point sees of each facet near it.
#pragma once

#include <cmath>
#include <cstdint>

#include "sph_server/kernel/facet_integrals.hpp"
#include "sph_server/kernel/view_cone.hpp"
#include "sph_server/kernel/visible_part.hpp"

namespace tandem::sph {

// What of a facet is hidden from x by others.
// Facet: has corners a, b, c, a unit `normal`, `height`, `cone`, `body` and `beyond`, see
// neighbours/near_facet.hpp.
template <class Facet>
class Hiding {
 public:
  TANDEM_HD Hiding(Vec3d x, const Facet& f, double tolerance)
      : x_(x), f_(f), corner_{f.a, f.b, f.c}, tolerance_(tolerance) {
    is_edge_on_ = std::fabs(f.height) <= tolerance;
    if (!is_edge_on_) cone_ = TriangleCone::of(x, f.a, f.b, f.c, f.height);
  }

  // May g hide a part of f? The tests are the planes that can separate g from what is between x and f.
  TANDEM_HD bool may(const Facet& g) const {
    if (std::fabs(g.height) <= tolerance_) return false;
    if (g.body == f_.body && (g.beyond & (g.height > 0 ? 2 : 1)) == 0) return false;
    if (f_.cone.is_apart_from(g.cone)) return false;
    const double side_g = g.height > 0 ? 1 : -1;
    if (!is_beyond(corner_, g.a, -side_g * g.normal)) return false;
    const Vec3d corner[3] = {g.a, g.b, g.c};
    if (!is_edge_on_) {
      const double side_f = f_.height > 0 ? 1 : -1;
      if (!is_beyond(corner, f_.a, side_f * f_.normal) || cone_.is_apart_from(x_, corner, tolerance_))
        return false;
    }
    return !TriangleCone::of(x_, g.a, g.b, g.c, g.height).is_apart_from(x_, corner_, tolerance_);
  }

 private:
  TANDEM_HD bool is_beyond(const Vec3d* corner, Vec3d origin, Vec3d normal) const {
    return dot(corner[0] - origin, normal) > tolerance_ || dot(corner[1] - origin, normal) > tolerance_ ||
           dot(corner[2] - origin, normal) > tolerance_;
  }

  Vec3d x_;
  const Facet& f_;
  Vec3d corner_[3];
  double tolerance_;
  bool is_edge_on_ = false;
  TriangleCone cone_;
};

// Facets: `count` of them in `facet`, of which facet k is seen. complete becomes false where so many facets
// hide parts of it that some are missing.
template <class Facets>
TANDEM_HD FacetIntegrals seen_integrals(Vec3d x, const Facets& near, int k, const WallKernel& kernel,
                                        bool& complete) {
  const auto& f = near.facet[k];
  const Vec3d corner[3] = {f.a, f.b, f.c};
  const double tolerance = 1e-6 * kernel.R;
  const Hiding hiding(x, f, tolerance);
  // The first facets that hide a part; those from `further` on are tested when they are needed.
  constexpr int most_listed = 32;
  particles::UninitialisedArray<std::int32_t, most_listed> hider;
  int listed = 0, further = 0;
  for (; further < near.count && listed < most_listed; ++further)
    if (further != k && hiding.may(near.facet[further])) hider[listed++] = further;
  if (listed == 0) return facet_integrals(x, corner, 3, f.normal, f.height, kernel);
  const auto shadow = [&](int n) {
    const int facet = n < listed ? hider[n] : further + n - listed;
    const auto& g = near.facet[facet];
    if (n >= listed && (facet == k || !hiding.may(g))) return Shadow{};
    return Shadow::of(x, g.a, g.b, g.c, g.normal, tolerance);
  };
  const int hiders = listed + near.count - further;
  FacetIntegrals sum;
  const auto add = [&](const Polygon& part) {
    sum += facet_integrals(x, part.corner.data(), part.count, f.normal, f.height, kernel);
  };
  // Fewer facets hide a piece of the triangle than the whole of it.
  for (int pieces = 1; pieces <= 256; pieces *= 2) {
    bool whole_sum = true;
    sum = {};
    for_pieces(corner, pieces, [&](const Polygon& piece) {
      whole_sum = whole_sum && for_visible_parts(piece, f.normal, x, kernel.R, hiders, shadow, add);
    });
    if (whole_sum) return sum;
  }
  complete = false;
  return sum;
}

}  // namespace tandem::sph
