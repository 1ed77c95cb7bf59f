// One micro step of one sphere: gather the forces at t, then leapfrog (symplectic Euler on half-step
// velocities):
//   v(t + dt/2) = v(t - dt/2) + dt (F(t)/m + g)        seed eq. 1
//   w(t + dt/2) = w(t - dt/2) + dt T(t)/I              seed eq. 2
//   x(t + dt)   = x(t) + dt v(t + dt/2)
// Second order in dt where forces do not depend on velocity, first order in the damping.
#pragma once

#include "dem_server/contact/forces.hpp"

namespace tandem::dem {

template <class Law, class Real>
struct MicroStep {
  View<Real> view;

  template <class Lanes, class Tally>
  TANDEM_HD void operator()(const Control& c, std::uint32_t i, const Lanes& lanes, Tally& tally) const {
    Place<Real> own = fetch(view.place[c.state_side] + i);
    Motion<Real> motion = fetch(view.motion[c.state_side] + i);
    if (!is_parked(own.x)) {
      const PairForces<Law, Real> pairs{view, c, own, motion};
      ForceSum<Real> sum = lanes.template sum_over<ForceSum<Real>>(
          pairs.list.start[i], pairs.list.start[i + 1], [&](std::uint32_t k) { return pairs.touches(k); },
          [&](std::uint32_t k, ForceSum<Real>& part) { pairs.add(k, part); });
      if (!lanes.leads()) return;
      if (const std::uint32_t near = view.near_of[i]; near != not_near) {
        const WallForce<Real> wall = view.wall_force[near];
        sum.force += wall.force;
        sum.torque += wall.torque;
      }
      integrate(c, sum, own, motion, tally);
    }
    if (!lanes.leads()) return;
    view.place[c.state_side ^ 1][i] = own;
    view.motion[c.state_side ^ 1][i] = motion;
  }

 private:
  template <class Tally>
  TANDEM_HD void integrate(const Control& c, const ForceSum<Real>& sum, Place<Real>& own,
                           Motion<Real>& motion, Tally& tally) const {
    const Parameters<Real>& p = view.parameters;
    const Inertia inertia = p.inertia(own);
    motion.v += (c.dt * inertia.inverse_mass) * sum.force + c.dt * p.gravity;
    if constexpr (Law::tangential) motion.w += static_cast<Real>(c.dt * inertia.inverse_moment) * sum.torque;
    own.x += c.dt * motion.v;

    const float speed2 = static_cast<float>(norm2(motion.v));
    if (!(speed2 < p.speed_limit * p.speed_limit)) tally.raise(not_finite, motion.id);
    tally.observe(speed2, sum.max_overlap_ratio);
    const bool inside = own.x.x >= p.domain_min.x && own.x.x < p.domain_max.x && own.x.y >= p.domain_min.y &&
                        own.x.y < p.domain_max.y && own.x.z >= p.domain_min.z && own.x.z < p.domain_max.z;
    if (!inside) {
      // The last row of the loads books what leaves: its momentum, and as "torque" x its mass times the steps
      // it stayed.
      tally.add_load(view.slots, inertia.mass * motion.v, {inertia.mass * (c.step + 1), 0, 0}, p.force,
                     p.torque);
      tally.count_lost();
      own.x = {parked, parked, parked};
      motion.v = {};
      motion.w = {};
    }
  }
};

}  // namespace tandem::dem
