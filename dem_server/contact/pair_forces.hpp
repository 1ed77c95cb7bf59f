// Forces between spheres. The CPU evaluates each pair once and reverses the force for the other sphere. A GPU
// evaluates it from both sides, with bitwise opposite results, because arithmetic costs it less than memory
// traffic. There are no atomic additions, so every sum has a fixed order.
#pragma once

#include "dem_server/contact/approach.hpp"
#include "dem_server/contact/extension.hpp"
#include "dem_server/contact/state_in_memory.hpp"

namespace tandem::dem {

// State of two spheres in contact: i owns the pair, j is the other.
template <class Real>
struct TouchingPair {
  Separation<Real> separation;        // from j to i
  Real radius = 0, other_radius = 0;  // [m]
  Vec3<Real> u;                       // velocity of i relative to j [m/s]
  Vec3<Real> w, other_w;              // angular velocities [rad/s]
  Coefficients<Real> k;
};

// The contact of a touching pair. `range`: distance beyond touching up to which the law may still act [m].
template <class Law, class Real>
TANDEM_HD Contact<Real> contact_of(const TouchingPair<Real>& m, LengthUnit<Real> unit, Real range, Real dt) {
  Contact<Real> c;
  c.overlap = overlap_of(m.separation, unit, c.n);
  if constexpr (Law::extended) c.overlap -= range;
  const Real arm = m.radius - c.overlap / 2, other_arm = m.other_radius - c.overlap / 2;
  Vec3<Real> u = m.u;
  if constexpr (Law::tangential) u -= cross(arm * m.w + other_arm * m.other_w, c.n);
  c.normal_speed = dot(u, c.n);
  c.slip = u - c.normal_speed * c.n;
  c.dt = dt;
  if constexpr (Law::tangential) c.normal_rotation = dt / 2 * dot(m.w + m.other_w, c.n);
  return c;
}

template <class Real>
struct PairResult {
  Vec3<Real> force;   // on i [N]
  Vec3<Real> couple;  // of friction: the torque on each sphere is this times its arm [N]
  Real overlap = 0;   // [m]
  Vec3<Real> spring;  // [m]
};

template <class Real>
TANDEM_HD PairResult<Real> result_of(const Contact<Real>& c, const ContactForce<Real>& f, Vec3<Real> spring) {
  return {f.normal * c.n + f.tangential, cross(f.tangential, c.n), c.overlap, spring};
}

template <class Law, class Arithmetic, class State = StateInMemory<Arithmetic>>
struct PairForces {
  using Real = Arithmetic;

  const View<Real>& view;
  const CurrentStep& now;
  State state;
  const PairList<Real>& list = view.lists.pairs;
  Real dt = static_cast<Real>(now.dt);

  // False only where entry k is not in contact with a sphere at `own`, and was not in the last step: a
  // contact that has just ended still has to be cleared. A GPU addresses several entries by one 64-bit
  // number, and only 32 bits where they are in shared memory.
  template <class Index>
  TANDEM_HD bool may_touch(PositionRadius<Real> own, Index k) const {
    const Neighbour neighbour = state.neighbour(k);
    PositionRadius<Real> other = state.position(neighbour.index());
    unwrap_pair(own, other, k);
    return (Law::tangential && neighbour.in_contact()) | Approach<Real>::may_touch(own, other, range());
  }

  // Loads entry k of sphere i; false where the two are not in contact.
  template <bool with_coefficients = true>
  TANDEM_HD bool find_touching(std::uint32_t i, std::uint32_t k, TouchingPair<Real>& m) const {
    const std::uint32_t j = state.neighbour(k).index();
    PositionRadius<Real> own = state.position(i), other = state.position(j);
    unwrap_pair(own, other, k);
    const Approach<Real> approach(own, other, range());
    if (!approach.touching()) return false;
    m = touching_pair<with_coefficients>(i, own, j, other, approach);
    return true;
  }
  // The tangential spring of entry k at the begin of the step; zero for a contact that is new.
  TANDEM_HD Vec3<Real> spring(std::uint32_t k, Neighbour neighbour) const {
    if constexpr (!Law::tangential) return {};
    const Vec3<Real> spring = list.spring[k];
    return neighbour.in_contact() ? spring : Vec3<Real>{};
  }

  // Evaluates entry k of sphere i. Returns whether the two are in contact; m, r and moment are valid only
  // then. `moment` is the sum of rolling and twisting.
  template <class Tally>
  TANDEM_HD bool operator()(std::uint32_t i, std::uint32_t k, TouchingPair<Real>& m, PairResult<Real>& r,
                            Vec3<Real>& moment, Tally& tally) const {
    return (*this)(i, k, state.neighbour(k), m, r, moment, tally);
  }
  // The same where the caller has loaded entry k.
  template <class Tally>
  TANDEM_HD bool operator()(std::uint32_t i, std::uint32_t k, Neighbour neighbour, TouchingPair<Real>& m,
                            PairResult<Real>& r, Vec3<Real>& moment, Tally& tally) const {
    bool touching = false;
    if constexpr (Law::extended) {
      touching = find_touching(i, k, m) && extended(i, k, neighbour, m, r, moment);
    } else {
      // Nearly all of these pairs are in contact. The test comes last, so that all loads are in flight at
      // once.
      const Vec3<Real> spring_so_far = spring(k, neighbour);
      const std::uint32_t j = neighbour.index();
      const PositionRadius<Real> own = state.position(i), other = state.position(j);
      const Approach<Real> approach(own, other, range());
      m = touching_pair(i, own, j, other, approach);
      r = result(m, spring_so_far);
      touching = approach.touching();
    }
    if (touching) {
      tally.observe_overlap(static_cast<float>(r.overlap * m.k.curvature));
      store_contact(k, neighbour, r);
    } else {
      end_contact(k, neighbour);
    }
    return touching;
  }

  // The force on the first of two spheres in contact, for laws that need only position and velocity [N].
  template <class Tally>
  TANDEM_HD Vec3<Real> force(const PositionRadius<Real>& own, const VelocityKind<Real>& own_velocity,
                             const PositionRadius<Real>& other, const VelocityKind<Real>& other_velocity,
                             const Approach<Real>& approach, Tally& tally) const {
    static_assert(!Law::tangential && !Law::extended);
    const TouchingPair<Real> m = touching_pair(own, own_velocity, other, other_velocity, approach);
    const PairResult<Real> r = result(m, {});
    tally.observe_overlap(static_cast<float>(r.overlap * m.k.curvature));
    return r.force;
  }

  // Stores the spring of entry k, which is in contact.
  TANDEM_HD void store_contact(std::uint32_t k, Neighbour was, const PairResult<Real>& r) const {
    if constexpr (Law::tangential) {
      list.spring[k] = r.spring;
      if (!was.in_contact()) state.set_neighbour(k, Neighbour::of(was.index(), true));
    }
  }
  // Ends the contact of entry k.
  TANDEM_HD void end_contact(std::uint32_t k, Neighbour was) const {
    if constexpr (Law::tangential)
      if (was.in_contact()) state.set_neighbour(k, Neighbour::of(was.index(), false));
  }

 private:
  // Only the generic variant has contacts across periodic faces.
  template <class Index>
  TANDEM_HD void unwrap_pair([[maybe_unused]] PositionRadius<Real>& own,
                             [[maybe_unused]] PositionRadius<Real>& other, [[maybe_unused]] Index k) const {
    if constexpr (Law::extended)
      if (list.image != nullptr) view.parameters.unwrap_pair(own, other, fetch(list.image + k));
  }

  // Distance beyond touching up to which there may be a contact.
  TANDEM_HD auto range() const {
    if constexpr (Law::extended)
      return view.parameters.range;
    else
      return typename LengthUnit<Real>::Count{};
  }

  template <bool with_coefficients = true>
  TANDEM_HD TouchingPair<Real> touching_pair(std::uint32_t i, const PositionRadius<Real>& own,
                                             std::uint32_t j, const PositionRadius<Real>& other,
                                             const Approach<Real>& approach) const {
    auto m = touching_pair<with_coefficients>(own, state.velocity(i), other, state.velocity(j), approach);
    if constexpr (Law::tangential) {
      m.w = state.spin(i).w;
      m.other_w = state.spin(j).w;
    }
    return m;
  }
  template <bool with_coefficients = true>
  TANDEM_HD TouchingPair<Real> touching_pair(const PositionRadius<Real>& own,
                                             const VelocityKind<Real>& own_velocity,
                                             const PositionRadius<Real>& other,
                                             const VelocityKind<Real>& other_velocity,
                                             const Approach<Real>& approach) const {
    const Parameters<Real>& p = view.parameters;
    TouchingPair<Real> m;
    m.separation = approach.separation();
    m.radius = p.radius(own);
    m.other_radius = p.radius(other);
    m.u = own_velocity.v - other_velocity.v;
    if constexpr (with_coefficients)
      m.k = p.between(own_velocity.kind(), m.radius, other_velocity.kind(), m.other_radius);
    return m;
  }

  TANDEM_HD PairResult<Real> result(const TouchingPair<Real>& m, Vec3<Real> spring) const {
    const Contact<Real> c = contact_of<Law>(m, view.parameters.unit, Real(0), dt);
    const ContactForce<Real> f = Law{}(c, m.k, view.parameters.law, spring);
    return result_of(c, f, spring);
  }

  TANDEM_HD bool extended(std::uint32_t i, std::uint32_t k, Neighbour neighbour, const TouchingPair<Real>& m,
                          PairResult<Real>& r, Vec3<Real>& moment) const {
    const Parameters<Real>& p = view.parameters;
    Contact<Real> c = contact_of<Law>(m, p.unit, p.unit.metres(p.range), dt);
    const Extension<Real> extension = extend(view, c, p.material(state.kind(i)), m.radius,
                                             p.material(state.kind(neighbour.index())), m.other_radius);
    const bool existed = neighbour.in_contact();
    if (!Law::in_contact(c, m.k, p.law, existed)) return false;
    const Vec3<Real> before = spring(k, neighbour);
    r.spring = before;
    const ContactForce<Real> f = Law{}(c, m.k, p.law, r.spring);
    r = result_of(c, f, r.spring);
    moment = rolling_moment(view, c, f, extension, m.k.friction, m.w - m.other_w,
                            list.rolling == nullptr ? nullptr : list.rolling + k, existed);
    // Of a pair of two ranks, that of the sphere with the entry adds it.
    if (view.dissipation.any() && view.spheres.owns(i))
      add_dissipation(view.dissipation, i, view.dissipation.of_pair, c, f, before, r.spring, moment,
                      m.w - m.other_w);
    return true;
  }
};

}  // namespace tandem::dem
