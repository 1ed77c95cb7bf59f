// Sums over the particles of a liquid between steps.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "particles/base/fixed_point.hpp"
#include "particles/state/centre.hpp"
#include "sph_server/equations/liquid.hpp"
#include "sph_server/equations/state.hpp"
#include "sph_server/step/advance.hpp"
#include "sph_server/step/arrays.hpp"

namespace tandem::sph {

// Momentum, energies and volume. They are sums of integers, so that every number of threads and every back
// end gives the same bits.
struct Totals {
  std::int64_t momentum[3]{}, kinetic = 0, compression = 0, expansion = 0;
  TANDEM_HD void add(const Totals& b) {
    for (int a = 0; a < 3; ++a) momentum[a] += b.momentum[a];
    kinetic += b.kinetic;
    compression += b.compression;
    expansion += b.expansion;
  }
};

struct TotalQuanta {
  particles::Quantum velocity, square, energy, expansion;  // of v, v^2, energy / (m c0^2), 1/(1 + e) - 1

  // Of `count` particles, none of which has more than this speed [m/s] and compression [-].
  static TotalQuanta of(std::size_t count, double speed, double compression) {
    const auto range = [count](double most) {
      return particles::Quantum::for_range(static_cast<double>(count) * std::max(most, 1e-150));
    };
    return {range(speed), range(speed * speed), range(tait_energy(compression) + tait_energy(-compression)),
            range(compression / (1 - compression))};
  }
};

template <class Real>
struct AddTotals {
  LiquidArrays<Real> liquid;
  TotalQuanta quanta;

  TANDEM_HD void operator()(std::uint32_t i, Totals& t) const {
    const Vec3d v = particles::velocity_of(liquid.velocity[i], liquid.fine_part(i));
    const double e = liquid.compression[i];
    for (int a = 0; a < 3; ++a) t.momentum[a] += particles::to_fixed(v[a], quanta.velocity);
    t.kinetic += particles::to_fixed(norm2(v), quanta.square);
    t.compression += particles::to_fixed(tait_energy(e), quanta.energy);
    t.expansion += particles::to_fixed(-e / (1 + e), quanta.expansion);
  }
};

// From the particle with the number `first` on.
template <class Real>
struct UpdateState {
  Advance<Real> advance;
  std::uint32_t first = 0;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (advance.liquid.number[i] >= first) advance.update_state(i);
  }
};

TANDEM_HD inline bool is_inside(const scene::Box& domain, Vec3d x) {
  for (int a = 0; a < 3; ++a)
    if (!(x[a] >= domain.min[a] && x[a] <= domain.max[a])) return false;
  return true;
}

// Particles that are where they cannot be.
struct Strays {
  std::uint32_t first_outside = ~0u;     // of the domain: its number
  std::uint32_t first_not_finite = ~0u;  // position or velocity
  std::uint32_t passed = 0;              // a wall
  TANDEM_HD void add(const Strays& b) {
    if (b.first_outside < first_outside) first_outside = b.first_outside;
    if (b.first_not_finite < first_not_finite) first_not_finite = b.first_not_finite;
    passed += b.passed;
  }
};

// Writes the positions for new lists.
template <class Real>
struct Locate {
  LiquidArrays<Real> liquid;
  particles::CentreUnit<Real> centres;
  particles::Periods periods;
  scene::Box domain;
  Vec3d* x = nullptr;
  // Those of the present lists, or null where there are none.
  const Vec3d* built_at = nullptr;
  const particles::BodyPose* built_pose = nullptr;
  ListView<std::uint32_t> facets;
  WallsView walls;
  static constexpr double largest2 = 1e300;  // beyond it squares are not finite

  TANDEM_HD void operator()(std::uint32_t i, Strays& strays) const {
    x[i] = centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)));
    const double size2 = norm2(x[i]) + norm2(particles::velocity_of(liquid.velocity[i], liquid.fine_part(i)));
    if (!(size2 < largest2)) strays.add({.first_not_finite = liquid.number[i]});
    if (!is_inside(domain, x[i])) strays.add({.first_outside = liquid.number[i]});
    if (built_at == nullptr) return;
    const Vec3d now = built_at[i] + periods.shortest(x[i] - built_at[i]);
    for (std::uint32_t n = facets.start[i]; n < facets.start[i + 1]; ++n)
      if (walls.passed(facets.entry[n], built_pose, built_at[i], now)) {
        ++strays.passed;
        break;
      }
  }
};

}  // namespace tandem::sph
