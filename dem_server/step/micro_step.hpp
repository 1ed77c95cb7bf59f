// One micro step, in three loops that a back end runs one after the other:
//
//   walls    over the spheres near a wall:   contact/wall_forces.hpp
//   pairs    over the listed pairs:          contact/pair_forces.hpp
//   motion   over the spheres: sums what the two have found at t, then leapfrog (symplectic Euler on
//            half-step velocities)
//     v(t + dt/2) = v(t - dt/2) + dt (F(t)/m + g)        seed eq. 1
//     w(t + dt/2) = w(t - dt/2) + dt T(t)/I              seed eq. 2
//     x(t + dt)   = x(t) + dt v(t + dt/2)
//
// Second order in dt where forces do not depend on velocity, first order in the damping.
#pragma once

#include "dem_server/contact/pair_forces.hpp"
#include "dem_server/contact/wall_forces.hpp"

namespace tandem::dem {

struct ForceSum {
  Vec3d force;   // [N]
  Vec3d torque;  // about the centre [N m]
};

// Sums over a sphere's pairs. Those in which it is the first and those in which it is the other are summed
// apart, each in the order of the lists, and then added: a GPU gives each sum to a thread, all of which do
// the same. Double, so that opposite forces cancel to the rounding of the state.
template <class Law, class Real>
struct PairSums {
  const View<Real>& view;
  const ListView<Real>& list;

  enum Side { first, other };
  enum Part { force, torque };

  // What pair k adds to sphere i: `force` or the torque that `couple` gives.
  TANDEM_HD Vec3d of_force(Side side, const PairVector<Real>& found) const {
    return (side == first ? found.value : -found.value).template as<double>();
  }
  TANDEM_HD Vec3d of_couple(std::uint32_t k, Side side, const PairVector<Real>& found, Real radius) const {
    Vec3<Real> turning = (radius - found.overlap / 2) * found.value;
    if constexpr (Law::extended)
      if (view.pair_moment != nullptr)
        turning += side == first ? view.pair_moment[k].moment : -view.pair_moment[k].moment;
    return turning.template as<double>();
  }

  // One thread sums all.
  TANDEM_HD ForceSum all(std::uint32_t i, Real radius) const {
    ForceSum total;
    for (const Side side : {first, other}) {
      ForceSum sum;
      const std::uint32_t* start = side == first ? list.start : view.mirror_start;
      for (std::uint32_t m = start[i]; m < start[i + 1]; ++m) {
        const std::uint32_t k = side == first ? m : view.mirror[m];
        if (view.touched[k] == 0) continue;
        sum.force += of_force(side, view.pair_force[k]);
        if constexpr (Law::tangential) sum.torque += of_couple(k, side, view.pair_couple[k], radius);
      }
      total.force += sum.force;
      total.torque += sum.torque;
    }
    return total;
  }

#if defined(__CUDACC__)
  // One of four sums; each of four threads takes one, and starts several loads at once.
  __device__ Vec3d one(std::uint32_t i, Side side, Part part, Real radius) const {
    constexpr std::uint32_t at_once = 8, none = ~0u;
    const std::uint32_t* start = side == first ? list.start : view.mirror_start;
    const PairVector<Real>* vector = part == force ? view.pair_force : view.pair_couple;
    Vec3d sum;
    const std::uint32_t end = fetch(start + i + 1);
    for (std::uint32_t base = fetch(start + i); base < end; base += at_once) {
      std::uint32_t pair[at_once];
      PairVector<Real> found[at_once];
#pragma unroll
      for (std::uint32_t m = 0; m < at_once; ++m) {
        const std::uint32_t k = base + m < end ? base + m : end - 1;
        pair[m] = side == first ? k : fetch(view.mirror + k);
        if (fetch(view.touched + pair[m]) == 0 || base + m >= end) pair[m] = none;
      }
#pragma unroll
      for (std::uint32_t m = 0; m < at_once; ++m)
        if (pair[m] != none) found[m] = fetch(vector + pair[m]);
#pragma unroll
      for (std::uint32_t m = 0; m < at_once; ++m) {
        if (pair[m] == none) continue;
        sum += part == force ? of_force(side, found[m]) : of_couple(pair[m], side, found[m], radius);
      }
    }
    return sum;
  }
#endif
};

template <class Law_, class Arithmetic>
struct MicroStep {
  using Law = Law_;
  using Real = Arithmetic;

  View<Real> view;

  TANDEM_HD WallForces<Law, Real> walls() const { return {view}; }
  TANDEM_HD PairForces<Law, Real> pairs(const Instant& now) const { return {view, now}; }
  TANDEM_HD PairSums<Law, Real> sums(const Instant& now) const { return {view, view.pairs[now.list_side]}; }

  // Moves sphere i, on which its pairs exert `force`.
  template <class Tally>
  TANDEM_HD void translate(const Instant& now, std::uint32_t i, Vec3d force, Tally& tally) const {
    const Parameters<Real>& p = view.parameters;
    Place<Real> place = fetch(view.place[now.state_side] + i);
    Drift<Real> drift = fetch(view.drift[now.state_side] + i);
    const Inertia inertia = p.inertia(drift.kind, p.radius(place));
    for (std::uint32_t k = view.near_start[i]; k < view.near_start[i + 1]; ++k)
      force += view.wall_force[k].force;
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

  // Turns sphere i, on which its pairs exert `torque`.
  TANDEM_HD void rotate(const Instant& now, std::uint32_t i, Vec3d torque) const {
    const Parameters<Real>& p = view.parameters;
    const Inertia inertia = p.inertia(fetch(&view.drift[now.state_side][i].kind), radius(now, i));
    for (std::uint32_t k = view.near_start[i]; k < view.near_start[i + 1]; ++k)
      torque += view.wall_force[k].torque.template as<double>();
    Spin<Real> spin = fetch(view.spin[now.state_side] + i);
    spin.w += ((now.dt * inertia.inverse_moment) * torque).template as<Real>();
    view.spin[now.state_side ^ 1][i] = spin;
  }

  TANDEM_HD Real radius(const Instant& now, std::uint32_t i) const {
    return view.parameters.radius(fetch(view.place[now.state_side] + i));
  }
};

}  // namespace tandem::dem
