// The sum over a sphere's contacts with others, in the order of its list: neighbours in higher slots, then
// those in lower ones.
#pragma once

#include "dem_server/model/view.hpp"

namespace tandem::dem {

// Double, so that opposite forces cancel to the rounding of the state.
struct ForceSum {
  Vec3d force;   // [N]
  Vec3d torque;  // about the centre [N m]
};

// Where pairs are evaluated once: the pairs that sphere i owns, then those of its mirror, which feel the
// opposite force and moment and the same couple.
template <class Law, class Real>
ForceSum sum_of_pairs(const View<Real>& view, const ListView<Real>& list, std::uint32_t i, Real radius) {
  ForceSum sum;
  const auto add = [&](std::uint32_t k, Real sign) {
    if (view.touched[k] == 0) return;
    const PairForce<Real> force = view.pair_force[k];
    sum.force += (sign * force.force).template as<double>();
    if constexpr (Law::tangential) {
      Vec3<Real> torque = (radius - force.overlap / 2) * view.pair_couple[k].per_arm;
      if constexpr (Law::extended)
        if (view.pair_moment != nullptr) torque += sign * view.pair_moment[k].moment;
      sum.torque += torque.template as<double>();
    }
  };
  for (std::uint32_t k = list.start[i]; k < list.start[i + 1]; ++k) add(k, 1);
  for (std::uint32_t m = view.mirror_start[i]; m < view.mirror_start[i + 1]; ++m) add(view.mirror[m], -1);
  return sum;
}

}  // namespace tandem::dem
