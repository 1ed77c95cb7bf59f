// What a liquid does to one body, in sums of integers.
#pragma once

#include <cstdint>

#include "particles/base/fixed_point.hpp"
#include "sph_server/step/pair_sums.hpp"

namespace tandem::sph {

// Sums of one body's walls, in quanta: of mass times acceleration, and of torque about the body's origin.
struct BodySum {
  std::int64_t acceleration[3]{};
  std::int64_t torque[3]{};

  TANDEM_HD void add(Vec3d by_mass, Vec3d moment, const Quanta& q) {
    for (int a = 0; a < 3; ++a) {
      acceleration[a] += particles::to_fixed(by_mass[a], q.acceleration);
      torque[a] += particles::to_fixed(moment[a], q.torque);
    }
  }
  TANDEM_HD void add(const BodySum& b) {
    for (int a = 0; a < 3; ++a) {
      acceleration[a] += b.acceleration[a];
      torque[a] += b.torque[a];
    }
  }
};

// What a back end sums up over i < n: f(i, tally, bodies), or f(i, team, tally, bodies) of F::by_teams.
template <class F>
struct SumOver {
  std::uint32_t n = 0;
  F f;
  bool shared = false;  // the facets of a particle are so many that several threads share them
};

}  // namespace tandem::sph
