// Energy that contacts dissipate, summed over a window from the forces of the dampers, of friction and of
// rolling themselves, not from what is missing in other energies. The sums are integers, so that they have
// the same bits for every number of threads and back end.
//
// Only the generic variant has them: the branch would make the micro steps of the others longer.
#pragma once

#include <cstdint>

#include "dem_server/laws/history.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/fixed_point.hpp"

namespace tandem::dem {

enum Dissipation : std::uint32_t {
  by_normal_damping,
  by_friction,  // all work of tangential forces, with the little that their springs store
  by_rolling,   // of rolling and twisting, likewise
  dissipation_count,
};
// Sums are spread over so many slots, so that threads seldom meet.
inline constexpr std::uint32_t dissipation_slots = 256;

struct DissipationView {
  std::int64_t* sum = nullptr;  // in quanta (dissipation_slots x dissipation_count); null: nothing is summed
  Quantum energy;               // [J]
  std::int64_t of_pair = 1;     // weight of half of a pair's energy: 2 where a pair is evaluated once

  TANDEM_HD bool any() const { return sum != nullptr; }
};

// Adds the energy of one contact in one micro step, `weight` times the half of it. `before` and `after` are
// its tangential spring, `moment` that of rolling and twisting on i, `rate` the relative rotation.
//
// The velocities of a contact are those half a step ago. So that the sums are second order in dt, the
// tangential spring works with the mean of its forces at both ends of that displacement, and the damper with
// the mean of the speeds before and after the step, which the force of the contact itself changes by F_n dt /
// m*. Both give nothing where spheres are at rest under load.
template <class Real>
TANDEM_HD void add_dissipation(const DissipationView& view, std::uint32_t sphere, std::int64_t weight,
                               const Contact<Real>& c, const ContactForce<Real>& f, Vec3<Real> before,
                               Vec3<Real> after, Vec3<Real> moment, Vec3<Real> rate) {
  const double dt = static_cast<double>(c.dt), normal = static_cast<double>(f.normal),
               damping = normal - static_cast<double>(f.elastic_force),
               speed = static_cast<double>(c.normal_speed) + 0.5 * dt / static_cast<double>(c.m_eff) * normal;
  const Vec3<Real> kept = rotate_spring(before, c, f.previous_stiffness2, f.current_stiffness2);
  const Vec3<Real> friction = f.tangential + (f.k_t / 2) * (after - kept);
  const double energy[dissipation_count] = {
      -dt * damping * speed, -dt * dot(friction.template as<double>(), c.slip.template as<double>()),
      -dt * dot(moment.template as<double>(), rate.template as<double>())};
  std::int64_t* sum = view.sum + std::size_t{sphere % dissipation_slots} * dissipation_count;
  for (std::uint32_t k = 0; k < dissipation_count; ++k)
    if (energy[k] != 0) add_shared(sum + k, weight * to_fixed(0.5 * energy[k], view.energy));
}

// Adds the sums of a window to those since the start, for entry k of the sums.
struct CloseDissipation {
  const std::int64_t* window;
  double* since_start;  // [J]
  Quantum energy;

  TANDEM_HD void operator()(std::uint32_t k) const {
    std::int64_t sum = 0;
    for (std::uint32_t slot = 0; slot < dissipation_slots; ++slot)
      sum += window[slot * dissipation_count + k];
    since_start[k] += from_fixed(sum, energy);
  }
};

}  // namespace tandem::dem
