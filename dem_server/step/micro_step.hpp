// One micro step, which a back end runs as
//
//   walls    over the spheres near a wall: contact/wall_forces.hpp
//   pairs    over the listed pairs: contact/pair_forces.hpp
//   motion   over the spheres: leapfrog (symplectic Euler on half-step velocities) with the sum of what the
//            two have found at t
//     v(t + dt/2) = v(t - dt/2) + dt (F(t)/m + g)        seed eq. 1
//     w(t + dt/2) = w(t - dt/2) + dt T(t)/I              seed eq. 2
//     x(t + dt)   = x(t) + dt v(t + dt/2)
//
// Second order in dt where forces do not depend on velocity, first order in the damping.
#pragma once

#include "dem_server/contact/pair_forces.hpp"
#include "dem_server/contact/wall_forces.hpp"

namespace tandem::dem {

template <class Law, class Real, class State = StateInMemory<Real>>
struct Motion {
  const View<Real>& view;
  const Instant& now;
  State state;

  // What sphere i knows of itself at a step's begin.
  struct Own {
    Place<Real> place;
    Drift<Real> drift;
    Spin<Real> spin;
    Remainder<Real> remainder;
    Range walls;  // its wall forces
  };
  TANDEM_HD Own own(std::uint32_t i) const {
    Own s;
    s.place = state.place(i);
    s.drift = state.drift(i);
    if constexpr (Law::tangential) s.spin = state.spin(i);
    s.remainder = state.remainder(i);
    s.walls = view.near_of(i, s.drift.label);
    return s;
  }

  // Moves sphere i, on which its pairs exert `force`.
  template <class Tally>
  TANDEM_HD void translate(std::uint32_t i, const Own& was, Vec3d force, Tally& tally) const {
    const Parameters<Real>& p = view.parameters;
    Place<Real> place = was.place;
    Drift<Real> drift = was.drift;
    const Inertia inertia = p.inertia(drift.kind(), p.radius(place));
    TANDEM_ROLLED
    for (std::uint32_t k = was.walls.begin; k < was.walls.end; ++k) force += state.wall_force(k).force;
    if (!is_parked(place)) {
      Remainder<Real> remainder = was.remainder;
      auto centre = p.centres.joined(place, remainder);
      const Vec3d v =
          velocity_of(drift, remainder) + ((now.dt * inertia.inverse_mass) * force + now.dt * p.gravity);

      const float speed2 = static_cast<float>(norm2(v));
      tally.observe_speed(speed2);
      if (speed2 < p.speed_limit * p.speed_limit) {
        centre += p.centres.of(now.dt * v);
        set_velocity(v, drift, remainder);
        p.centres.split(centre, place, remainder);
      } else {
        // It stays there, so that the error can tell what it did before.
        tally.raise(not_finite, Law::tangential ? was.spin.id : view.id[i]);
      }
      if (!view.inside_domain(centre)) {
        // The last row of the loads books what leaves: its momentum, and as "torque" x its mass times the
        // steps it stayed.
        tally.add_load(view.slots, inertia.mass * velocity_of(drift, remainder),
                       {inertia.mass * (now.step + 1), 0, 0}, p.force, p.torque);
        tally.count_lost();
        place.radius = parked_radius<Real>;
      }
      state.remember(i, remainder);
    }
    state.move(i, place, drift);
  }

  // Turns sphere i, on which its pairs exert `torque`.
  TANDEM_HD void rotate(std::uint32_t i, const Own& was, Vec3d torque) const {
    const Inertia inertia = view.parameters.inertia(was.drift.kind(), view.parameters.radius(was.place));
    TANDEM_ROLLED
    for (std::uint32_t k = was.walls.begin; k < was.walls.end; ++k)
      torque += state.wall_force(k).torque.template as<double>();
    Spin<Real> spin = was.spin;
    spin.w += ((now.dt * inertia.inverse_moment) * torque).template as<Real>();
    state.turn(i, spin);
  }
};

template <class Law_, class Arithmetic>
struct MicroStep {
  using Law = Law_;
  using Real = Arithmetic;

  View<Real> view;

  template <class State>
  TANDEM_HD WallForces<Law, Real, State> walls(const Instant& now, const State& state) const {
    return {view, now, state};
  }
  template <class State>
  TANDEM_HD PairForces<Law, Real, State> pairs(const Instant& now, const State& state) const {
    return {view, now, state};
  }
  template <class State>
  TANDEM_HD Motion<Law, Real, State> motion(const Instant& now, const State& state) const {
    return {view, now, state};
  }
};

}  // namespace tandem::dem
