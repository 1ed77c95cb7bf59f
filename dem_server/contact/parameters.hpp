// Numbers of a run that every contact needs: materials and pairs, gravity, quanta of the exact sums.
#pragma once

#include <cmath>
#include <cstdint>

#include "common/scene/model.hpp"
#include "dem_server/laws/coefficients.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/arithmetic.hpp"
#include "particles/base/fixed_point.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/state/centre.hpp"
#include "particles/state/particles.hpp"

namespace tandem::dem {

struct Inertia {
  double mass = 0;            // [kg]
  double inverse_mass = 0;    // [1/kg]
  double inverse_moment = 0;  // of 2/5 m r^2 [1/(kg m2)]
};

inline constexpr double largest_speed = 1e5;  // of a sphere, above that of any valid run [m/s]
inline constexpr std::uint32_t max_materials = 8;
inline constexpr std::uint32_t max_kinds = 8;
static_assert(max_kinds <= Label::kinds && max_materials <= Label::kinds);

template <class Real>
struct Parameters {
  PairConstants<Real> pair[max_materials * max_materials];  // row a, column b
  Real mass_per_volume[max_materials]{};                    // 4/3 pi density: mass = this r^3 [kg/m3]
  std::uint32_t materials = 0;
  // Only for the generic variant:
  std::uint32_t law = 0;  // scene::ContactLaw
  bool rolling = false, twisting = false;
  typename LengthUnit<Real>::Count range{};  // distance beyond touching up to which adhesion may act
  // Most scenes have few kinds of spheres, a kind being a material and a radius. Quantities that depend on
  // kinds alone are then tabulated. kinds == 0 means that there are too many: the kind of a sphere is then
  // its material, and every quantity is computed where it is needed.
  std::uint32_t kinds = 0;
  std::uint32_t kind_material[max_kinds]{};
  Real kind_radius[max_kinds]{};  // [m]
  Inertia kind_inertia[max_kinds];
  Coefficients<Real> kind_pair[max_kinds * max_kinds];
  Coefficients<Real> kind_wall[max_kinds * max_materials];
  Vec3d gravity;           // [m/s2]
  Quantum force, torque;   // of wall loads [N] [N m]
  double force_limit = 0;  // largest wall force that the exact sums admit [N]
  float speed_limit = 0;   // a faster sphere fails the run; at most largest_speed [m/s]

  using Centre = typename CentreUnit<Real>::Centre;
  LengthUnit<Real> unit;          // of PositionRadius
  CentreUnit<Real> centres;       // of a sphere's centre in full resolution
  Centre domain_min, domain_max;  // unbounded along periodic axes

  Periods periods;
  typename LengthUnit<Real>::Count period[3]{};  // lengths along x, y, z

  TANDEM_HD Real radius(const PositionRadius<Real>& s) const { return unit.metres(s.radius); }
  TANDEM_HD PositionRadius<Real> placed(Vec3d x, typename LengthUnit<Real>::Count radius) const {
    return {unit.count(x.x), unit.count(x.y), unit.count(x.z), radius};
  }
  // Moves one of two spheres that are in contact across periodic faces next to the other; `image` is that of
  // `other`. The upper of the two is always the one that moves down, so that both spheres compute exactly
  // opposite distances.
  TANDEM_HD void unwrap_pair(PositionRadius<Real>& own, PositionRadius<Real>& other, Image image) const {
    if (image == 0) return;
    const auto along = [&](int axis, auto coordinate) {
      if (image & image_above(axis)) own.*coordinate = unit.minus(own.*coordinate, period[axis]);
      if (image & image_below(axis)) other.*coordinate = unit.minus(other.*coordinate, period[axis]);
    };
    along(0, &PositionRadius<Real>::x);
    along(1, &PositionRadius<Real>::y);
    along(2, &PositionRadius<Real>::z);
  }
  TANDEM_HD Vec3d centre(const PositionRadius<Real>& position, const FinePart<Real>& fine) const {
    return centres.metres(centres.joined(position, fine));  // [m]
  }
  TANDEM_HD bool inside_domain(Centre x) const {
    return x.x >= domain_min.x && x.x < domain_max.x && x.y >= domain_min.y && x.y < domain_max.y &&
           x.z >= domain_min.z && x.z < domain_max.z;
  }

  TANDEM_HD std::uint32_t material(std::uint32_t kind) const {
    return kinds > 0 ? kind_material[kind] : kind;
  }

  TANDEM_HD Inertia inertia(std::uint32_t kind, Real radius) const {
    return kinds > 0 ? kind_inertia[kind] : computed_inertia(kind, radius);
  }
  TANDEM_HD Inertia computed_inertia(std::uint32_t m, Real radius) const {
    const double mass = static_cast<double>(sphere_mass(mass_per_volume[m], radius)),
                 r = static_cast<double>(radius);
    return {mass, 1 / mass, 1 / (0.4 * mass * r * r)};
  }

  TANDEM_HD Coefficients<Real> between(std::uint32_t a, Real radius_a, std::uint32_t b, Real radius_b) const {
    return kinds > 0 ? kind_pair[a * max_kinds + b] : computed_pair(a, radius_a, b, radius_b);
  }
  TANDEM_HD Coefficients<Real> computed_pair(std::uint32_t m, Real r, std::uint32_t other_m,
                                             Real other_r) const {
    return coefficients_of_spheres(pair[m * max_materials + other_m], sphere_mass(mass_per_volume[m], r), r,
                                   sphere_mass(mass_per_volume[other_m], other_r), other_r);
  }
  // A flat wall has no curvature. Its motion does not depend on this contact within a step, so m* = m.
  TANDEM_HD Coefficients<Real> with_wall(std::uint32_t kind, Real radius, std::uint32_t wall_material) const {
    return kinds > 0 ? kind_wall[kind * max_materials + wall_material]
                     : computed_wall(kind, radius, wall_material);
  }
  TANDEM_HD Coefficients<Real> computed_wall(std::uint32_t m, Real radius,
                                             std::uint32_t wall_material) const {
    return coefficients(pair[m * max_materials + wall_material], radius,
                        sphere_mass(mass_per_volume[m], radius), radius);
  }
  // A ball is curved (contact/wall_curvature.hpp).
  TANDEM_HD Coefficients<Real> with_ball(std::uint32_t kind, Real radius, std::uint32_t wall_material,
                                         Real r_eff, Real smaller_radius) const {
    const std::uint32_t m = material(kind);
    return coefficients(pair[m * max_materials + wall_material], r_eff,
                        sphere_mass(mass_per_volume[m], radius), smaller_radius);
  }
};

// Largest length that is counted in quanta [m]. While lists are built, two spheres are compared along an axis
// at up to two cell edges of the largest spheres, an edge being their diameter plus the skin; that distance
// has to stay below 2^31 quanta. Listed pairs are within one edge, whose square fits into 63 bits.
inline double counted_length(double largest_radius, double largest_skin) {
  return 1.225 * (2 * largest_radius + largest_skin);
}

// The periods of a scene, rounded to whole quanta of positions in mixed precision: by less than 1e-9 of the
// largest diameter. Double precision uses the same rounded periods.
Periods periods_for_spheres(const scene::Dem& dem, double largest_radius, double largest_skin);

// Error{scene} for more materials than the table holds.
template <class Real>
Parameters<Real> make_parameters(const scene::Scene& scene, const Spheres& spheres, double largest_skin);

// (max_materials x max_materials)
template <class Real>
std::vector<PairExtras<Real>> make_pair_extras(const scene::Scene& scene);

// Fills the tables of `p` from its materials and pairs.
template <class Real>
void tabulate_kinds(Parameters<Real>& p, const Spheres& spheres);

// The kind of each sphere, or its material where there are too many kinds.
template <class Real>
std::vector<std::uint32_t> kinds_of(const Parameters<Real>& parameters, const Spheres& spheres);

}  // namespace tandem::dem
