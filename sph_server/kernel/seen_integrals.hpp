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

// Facets that may hide a part of another one: bit n for facet n of a list, the last bit for all from there
// on.
using Hiders = std::uint64_t;
inline constexpr int listed_hiders = 63;

// Facets: `count` of them in `facet`. Those that may hide a part of facet k from x.
template <class Facets>
TANDEM_HD Hiders hiders_of(Vec3d x, const Facets& near, int k, const WallKernel& kernel) {
  const Hiding hiding(x, near.facet[k], 1e-6 * kernel.R);
  Hiders hiders = 0;
  for (int n = 0; n < near.count; ++n)
    if (n != k && hiding.may(near.facet[n])) {
      hiders |= Hiders{1} << (n < listed_hiders ? n : listed_hiders);
      if (n >= listed_hiders) break;
    }
  return hiders;
}

template <class Facet>
TANDEM_HD FacetIntegrals whole_integrals(Vec3d x, const Facet& f, const WallKernel& kernel) {
  const Vec3d corner[3] = {f.a, f.b, f.c};
  return facet_integrals(x, corner, 3, f.normal, f.height, kernel);
}

// Of facet k, without what the hiders hide. complete becomes false where so many facets hide parts of it that
// some are missing.
template <class Facets>
TANDEM_HD FacetIntegrals partial_integrals(Vec3d x, const Facets& near, int k, Hiders hiders,
                                           const WallKernel& kernel, bool& complete) {
  const auto& f = near.facet[k];
  const Vec3d corner[3] = {f.a, f.b, f.c};
  const double tolerance = 1e-6 * kernel.R;
  particles::UninitialisedArray<std::uint8_t, listed_hiders> hider;
  int listed = 0;
  for (int n = 0; n < listed_hiders; ++n)
    if (hiders >> n & 1) hider[listed++] = static_cast<std::uint8_t>(n);
  const int further = hiders >> listed_hiders != 0 ? near.count - listed_hiders : 0;
  const auto shadow = [&](int n) {
    const int facet = n < listed ? hider[n] : listed_hiders + n - listed;
    const auto& g = near.facet[facet];
    if (n >= listed && (facet == k || !Hiding(x, f, tolerance).may(g))) return Shadow{};
    return Shadow::of(x, g.a, g.b, g.c, g.normal, tolerance);
  };
  FacetIntegrals sum;
  // Fewer facets hide a piece of the triangle than the whole of it.
  for (int pieces = 1; pieces <= 256; pieces *= 2) {
    bool whole_sum = true;
    sum = {};
    for_pieces(corner, pieces, [&](const Polygon& piece) {
      if (!whole_sum) return;
      VisibleParts parts(piece, f.normal, x, kernel.R, listed + further, shadow);
      for (Polygon part; parts.find_next(part);)
        sum += facet_integrals(x, part.corner.data(), part.count, f.normal, f.height, kernel);
      whole_sum = parts.complete();
    });
    if (whole_sum) return sum;
  }
  complete = false;
  return sum;
}

// Of facet k, as x sees it.
template <class Facets>
TANDEM_HD FacetIntegrals seen_integrals(Vec3d x, const Facets& near, int k, const WallKernel& kernel,
                                        bool& complete) {
  const Hiders hiders = hiders_of(x, near, k, kernel);
  return hiders == 0 ? whole_integrals(x, near.facet[k], kernel)
                     : partial_integrals(x, near, k, hiders, kernel, complete);
}

}  // namespace tandem::sph
