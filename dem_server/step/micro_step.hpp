// One micro step of one sphere: gather the forces at t, then leapfrog (symplectic Euler on half-step
// velocities):
//   v(t + dt/2) = v(t - dt/2) + dt (F(t)/m + g)        seed eq. 1
//   w(t + dt/2) = w(t - dt/2) + dt T(t)/I              seed eq. 2
//   x(t + dt)   = x(t) + dt v(t + dt/2)
// Second order in dt where forces do not depend on velocity, first order in the damping.
#pragma once

#include "dem_server/contact/pair_forces.hpp"

namespace tandem::dem {

template <class Law, class Arithmetic>
struct MicroStep {
  using Real = Arithmetic;
  View<Real> view;

  // The sum over neighbours, which `gather` shares among threads. i may lie beyond the last sphere, since a
  // GPU's threads come in whole warps.
  template <class Gather, class Tally>
  TANDEM_HD ForceSum pairs(const Instant& now, std::uint32_t i, const Gather& gather, Tally& tally) const {
    return gather(PairForces<Law, Real>{view, now}, i, tally);
  }

  // Adds the walls' forces and moves sphere i < n.
  template <class Gather, class Tally>
  TANDEM_HD void move(const Instant& now, std::uint32_t i, ForceSum sum, const Gather& gather,
                      Tally& tally) const {
    const Place<Real> place = fetch(view.place[now.state_side] + i);
    const Drift<Real> drift = fetch(view.drift[now.state_side] + i);
    const Inertia inertia = view.parameters.inertia(drift.kind, view.parameters.radius(place));
    const std::uint32_t first_wall = view.near_start[i], last_wall = view.near_start[i + 1];
    if (gather.moves()) {
      for (std::uint32_t k = first_wall; k < last_wall; ++k) sum.force += view.wall_force[k].force;
      translate(now, i, sum.force, inertia, place, drift, tally);
    }
    if constexpr (Law::tangential) {
      if (gather.turns()) {
        for (std::uint32_t k = first_wall; k < last_wall; ++k)
          sum.torque += view.wall_force[k].torque.template as<double>();
        Spin<Real> spin = fetch(view.spin[now.state_side] + i);
        spin.w += ((now.dt * inertia.inverse_moment) * sum.torque).template as<Real>();
        view.spin[now.state_side ^ 1][i] = spin;
      }
    }
  }

 private:
  template <class Tally>
  TANDEM_HD void translate(const Instant& now, std::uint32_t i, Vec3d force, const Inertia& inertia,
                           Place<Real> place, Drift<Real> drift, Tally& tally) const {
    const Parameters<Real>& p = view.parameters;
    if (!is_parked(place)) {
      Exact own = view.exact[now.list_side][i];
      own.v += (now.dt * inertia.inverse_mass) * force + now.dt * p.gravity;
      own.x += now.dt * own.v;

      const float speed2 = static_cast<float>(norm2(own.v));
      if (!(speed2 < p.speed_limit * p.speed_limit)) tally.raise(not_finite, view.id[now.list_side][i]);
      tally.observe_speed(speed2);
      drift.v = own.v.template as<Real>();
      place = p.placed(own.x, place.radius);
      if (!p.inside_domain(own.x)) {
        // The last row of the loads books what leaves: its momentum, and as "torque" x its mass times the
        // steps it stayed.
        tally.add_load(view.slots, inertia.mass * own.v, {inertia.mass * (now.step + 1), 0, 0}, p.force,
                       p.torque);
        tally.count_lost();
        place.radius = parked_radius<Real>;
      }
      view.exact[now.list_side][i] = own;
    }
    view.place[now.state_side ^ 1][i] = place;
    view.drift[now.state_side ^ 1][i] = drift;
  }
};

}  // namespace tandem::dem
