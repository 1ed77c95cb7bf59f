// One micro step, which a back end runs as
//
//   walls    over the spheres near a wall: contact/wall_forces.hpp
//   pairs    over the listed pairs: contact/pair_forces.hpp
//   motion   over the spheres: leapfrog (symplectic Euler on half-step velocities) with the sum of the
//            forces that the two have computed at t
//     v(t + dt/2) = v(t - dt/2) + dt (F(t)/m + g)        [MbdDem] eq. 1
//     w(t + dt/2) = w(t - dt/2) + dt T(t)/I              [MbdDem] eq. 2
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
  const CurrentStep& now;
  State state;

  // State of sphere i at the begin of a step.
  struct Own {
    PositionRadius<Real> position;
    VelocityKind<Real> velocity;
    Spin<Real> spin;
    FinePart<Real> fine;
    Range walls;  // entries of its wall forces
  };
  TANDEM_HD Own own(std::uint32_t i) const {
    Own s;
    s.position = state.position(i);
    s.velocity = state.velocity(i);
    if constexpr (Law::tangential) s.spin = state.spin(i);
    s.fine = state.fine(i);
    s.walls = view.near_of(i, s.velocity.label);
    return s;
  }

  // Moves sphere i by one step; `force` is the sum over its pairs.
  template <class Tally>
  TANDEM_HD void translate(std::uint32_t i, const Own& was, Vec3d force, Tally& tally) const {
    const Parameters<Real>& p = view.parameters;
    PositionRadius<Real> position = was.position;
    VelocityKind<Real> velocity = was.velocity;
    const Inertia inertia = p.inertia(velocity.kind(), p.radius(position));
    TANDEM_ROLLED
    for (std::uint32_t k = was.walls.begin; k < was.walls.end; ++k) force += state.wall_force(k).force;
    if (!is_parked(position)) {
      FinePart<Real> fine = was.fine;
      auto centre = p.centres.joined(position, fine);
      const Vec3d v =
          velocity_of(velocity, fine) + ((now.dt * inertia.inverse_mass) * force + now.dt * p.gravity);

      const float speed2 = static_cast<float>(norm2(v));
      tally.observe_speed(speed2);
      if (speed2 < p.speed_limit * p.speed_limit) {
        centre += p.centres.of(now.dt * v);
        set_velocity(v, velocity, fine);
        p.centres.split(centre, position, fine);
      } else {
        // The sphere keeps its position and velocity, so that the error can report them.
        tally.raise(not_finite, Law::tangential ? was.spin.id : view.spheres.id[i]);
      }
      if (!view.inside_domain(centre)) {
        // The last row of the loads records spheres that leave the domain: as force their momentum; as torque
        // x their mass times the micro steps that they stayed.
        tally.add_load(view.surface.bodies, inertia.mass * velocity_of(velocity, fine),
                       {inertia.mass * (now.step + 1), 0, 0}, p.force, p.torque);
        tally.count_lost();
        position.radius = parked_radius<Real>;
      }
      state.set_fine_part(i, fine);
    }
    state.move(i, position, velocity);
  }

  // Updates the angular velocity of sphere i; `torque` is the sum over its pairs.
  TANDEM_HD void rotate(std::uint32_t i, const Own& was, Vec3d torque) const {
    const Inertia inertia =
        view.parameters.inertia(was.velocity.kind(), view.parameters.radius(was.position));
    TANDEM_ROLLED
    for (std::uint32_t k = was.walls.begin; k < was.walls.end; ++k)
      torque += state.wall_force(k).torque.template as<double>();
    Spin<Real> spin = was.spin;
    spin.w += ((now.dt * inertia.inverse_moment) * torque).template as<Real>();
    state.set_spin(i, spin);
  }
};

template <class Law_, class Arithmetic>
struct MicroStep {
  using Law = Law_;
  using Real = Arithmetic;

  View<Real> view;

  template <class State>
  TANDEM_HD WallForces<Law, Real, State> walls(const CurrentStep& now, const State& state) const {
    return {view, now, state};
  }
  template <class State>
  TANDEM_HD PairForces<Law, Real, State> pairs(const CurrentStep& now, const State& state) const {
    return {view, now, state};
  }
  template <class State>
  TANDEM_HD Motion<Law, Real, State> motion(const CurrentStep& now, const State& state) const {
    return {view, now, state};
  }
};

}  // namespace tandem::dem
