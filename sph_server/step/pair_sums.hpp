// Sums of one particle over its neighbours: the only pass over the neighbours in a step.
#pragma once

#include <cmath>
#include <cstdint>

#include "particles/base/exact_sum.hpp"
#include "sph_server/equations/pair_terms.hpp"
#include "sph_server/equations/shift.hpp"
#include "sph_server/neighbours/apart.hpp"
#include "sph_server/step/arrays.hpp"

namespace tandem::sph {

struct Quanta {
  particles::Quantum acceleration;  // [m/s2]
  particles::Quantum rate;          // [1/s]
  particles::Quantum power;         // [W]
  particles::Quantum torque;        // [N m]
  particles::Quantum square;        // of Mach numbers and compressions [-]
};

TANDEM_HD inline Vec3d metric(const std::int64_t (&acceleration)[3], const Quanta& q) {
  return {particles::from_fixed(acceleration[0], q.acceleration),
          particles::from_fixed(acceleration[1], q.acceleration),
          particles::from_fixed(acceleration[2], q.acceleration)};
}

// Fixed-point sums are of rounded addends that are antisymmetric to the bit, so that the sums over all
// particles vanish exactly. The others depend on the order of the list.
template <class Real, bool shifting>
struct PairSums {
  std::int64_t acceleration[3]{};  // by pressure and viscosity, in quanta
  std::int64_t continuity = 0;     // in quanta
  std::int64_t diffusion = 0;
  Vec3<Real> viscous;       // the part of the acceleration by viscosity [m/s2]
  Real viscous_power = 0;   // of viscosity, of both particles of a pair, divided by the mass [W/kg]
  Real filled = 0;          // sum of V_j W: part of the kernel that neighbours fill [-]
  std::uint32_t burst = 0;  // not 0: a term is beyond the range of the sums, or no number
  Crowding<Real, shifting> crowding;

  TANDEM_HD void add(const PairSums& b) {
    for (int a = 0; a < 3; ++a) acceleration[a] += b.acceleration[a];
    continuity += b.continuity;
    diffusion += b.diffusion;
    viscous += b.viscous;
    viscous_power += b.viscous_power;
    filled += b.filled;
    burst |= b.burst;
    if constexpr (shifting) {
      crowding.gradient += b.crowding.gradient;
      crowding.deformation += b.crowding.deformation;
    }
  }
};

// Four lanes share the neighbours of a particle. A back end adds their sums up as (0 + 1) + (2 + 3).
inline constexpr std::uint32_t lanes = 4;

// Is a term beyond the range of the sums, or no number? factor: the acceleration divided by the distance.
template <class Real>
TANDEM_HD bool is_beyond(const PairTerms<Real>& t, Real factor, const PairConstants<Real>& c,
                         const particles::AddendScale<Real>& of_acceleration,
                         const particles::AddendScale<Real>& of_rate) {
  using std::fabs;
  // Without branches, which keep a compiler from evaluating several pairs at once.
  const bool force = fabs(factor) * c.kernel.support <= static_cast<Real>(of_acceleration.bound),
             continuity = fabs(t.continuity) <= static_cast<Real>(of_rate.bound),
             diffusion = fabs(t.diffusion) <= static_cast<Real>(of_rate.bound);
  return !(force & continuity & diffusion);
}

template <class Real, bool shifting>
struct SumPairs {
  using Sums = PairSums<Real, shifting>;
  LiquidArrays<Real> liquid;
  Apart<Real> apart;
  PairConstants<Real> pair;
  particles::AddendScale<Real> of_acceleration;  // in Quanta::acceleration
  particles::AddendScale<Real> of_rate;          // in Quanta::rate
  Sums* result = nullptr;                        // (count)

  // The sums of one lane.
  TANDEM_HD Sums of_lane(std::uint32_t i, std::uint32_t lane) const {
    using std::fabs;
    Sums sum;
    particles::ExactSum<Real> acceleration[3], continuity, diffusion;
    std::uint32_t addends = 0;
    const ParticleState<Real> self = liquid.state[i];
    const particles::PositionRadius<Real> here = liquid.position[i];
    const std::uint32_t end = liquid.neighbours.end[i];
    for (std::uint32_t n = liquid.neighbours.start[i] + lane; n < end; n += lanes) {
      const Neighbour neighbour = liquid.neighbours.entry[n];
      const std::uint32_t j = neighbour.index();
      const Vec3<Real> d = apart(here, liquid.position[j], neighbour.image());
      const Real r2 = norm2(d);
      if (r2 >= pair.support2) continue;
      const ParticleState<Real> other = liquid.state[j];
      const PairTerms<Real> t = pair_terms(pair, d, r2, self, other);
      const Real factor = t.pressure + t.viscous;
      const Vec3<Real> force = factor * d, viscous = t.viscous * d;
      for (int a = 0; a < 3; ++a) acceleration[a].add(force[a], of_acceleration);
      continuity.add(t.continuity, of_rate);
      diffusion.add(t.diffusion, of_rate);
      sum.burst |= is_beyond(t, factor, pair, of_acceleration, of_rate) ? 1u : 0u;
      sum.viscous += viscous;
      sum.viscous_power += t.viscous * t.approach;
      sum.filled += other.volume * t.kernel;
      if constexpr (shifting) sum.crowding.add(pair, d, t, other.volume);
      ++addends;
    }
    for (int a = 0; a < 3; ++a) sum.acceleration[a] = acceleration[a].value(of_acceleration, addends);
    sum.continuity = continuity.value(of_rate, addends);
    sum.diffusion = diffusion.value(of_rate, addends);
    sum.burst |= addends > particles::most_addends;
    return sum;
  }
  TANDEM_HD void take(std::uint32_t i, const Sums& sum) const { result[i] = sum; }
};

}  // namespace tandem::sph
