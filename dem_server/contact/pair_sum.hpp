// The sum over a sphere's contacts with other spheres, in the order of its list: neighbours with higher
// indices, then those with lower ones.
#pragma once

#include "dem_server/contact/view.hpp"

namespace tandem::dem {

// Double precision, so that opposite forces cancel up to the rounding of the state.
struct ForceSum {
  Vec3d force;   // [N]
  Vec3d torque;  // about the centre [N m]
};

// For pairs that are evaluated once: first the pairs that sphere i owns, then those in which it is the other
// one, which receives the opposite force and moment and the same couple. Pairs that are not in contact add
// zeros. The sum starts with +0, so these leave its bits unchanged.
template <class Law, class Real>
ForceSum sum_of_pairs(const ClosePairs<Real>& close, std::uint32_t i, Real radius) {
  ForceSum sum;
  const auto add = [&](std::uint32_t number, Real sign) {
    const PairForce<Real> force = close.force[number];
    sum.force += (sign * force.force).template as<double>();
    if constexpr (Law::tangential) {
      Vec3<Real> torque = (radius - force.overlap / 2) * close.couple[number].per_arm;
      if constexpr (Law::extended)
        if (close.moment != nullptr) torque += sign * close.moment[number].moment;
      sum.torque += torque.template as<double>();
    }
  };
  const Range owned = close.owned[i], mirrored = close.mirrored[i];
  for (std::uint32_t number = owned.begin; number < owned.end; ++number) add(number, 1);
  for (std::uint32_t m = mirrored.begin; m < mirrored.end; ++m) add(close.mirror[m], -1);
  return sum;
}

}  // namespace tandem::dem
