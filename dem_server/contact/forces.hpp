// The force that a sphere's neighbours exert on it: gathered, each sphere owns its contacts, so nothing is
// added atomically between spheres; a pair is evaluated from both sides with bitwise opposite results.
#pragma once

#include "dem_server/core/fetch.hpp"
#include "dem_server/model/view.hpp"

namespace tandem::dem {

// Sum over contacts. The force is double, so that opposite forces cancel to the rounding of the state.
template <class Real>
struct ForceSum {
  Vec3d force;        // [N]
  Vec3<Real> torque;  // about the centre [N m]
  float max_overlap_ratio = 0;

  TANDEM_HD void see_overlap(Real overlap, Real radius) {
    const float ratio = static_cast<float>(overlap / radius);
    if (ratio > max_overlap_ratio) max_overlap_ratio = ratio;
  }
  TANDEM_HD ForceSum& operator+=(const ForceSum& b) {
    force += b.force;
    torque += b.torque;
    if (b.max_overlap_ratio > max_overlap_ratio) max_overlap_ratio = b.max_overlap_ratio;
    return *this;
  }
#if defined(__CUDACC__)
  // What thread `source` of a group of `width` neighbours has.
  __device__ ForceSum shuffled(unsigned group, int source, int width) const {
    const auto of = [&](auto x) { return __shfl_sync(group, x, source, width); };
    ForceSum b;
    b.force = {of(force.x), of(force.y), of(force.z)};
    b.torque = {of(torque.x), of(torque.y), of(torque.z)};
    b.max_overlap_ratio = of(max_overlap_ratio);
    return b;
  }
  __device__ void shuffle_add(unsigned group, int distance) {
    const auto of = [&](auto x) { return __shfl_xor_sync(group, x, distance); };
    ForceSum b;
    b.force = {of(force.x), of(force.y), of(force.z)};
    b.torque = {of(torque.x), of(torque.y), of(torque.z)};
    b.max_overlap_ratio = of(max_overlap_ratio);
    *this += b;
  }
#endif
};

// Evaluates the law with the contact's history, which a law without friction has not.
template <class Law, class Real>
TANDEM_HD ContactForce<Real> contact_force(const Contact<Real>& c, const Coefficients<Real>& k,
                                           std::uint32_t law, History<Real>* history, std::uint32_t stamp) {
  Vec3<Real> spring;
  if constexpr (Law::tangential) {
    const History<Real> h = *history;
    // Touched in the last step: the contact goes on. Otherwise it is new.
    if (h.stamp == stamp - 1) spring = h.spring;
  }
  const ContactForce<Real> f = Law{}(c, k, law, spring);
  if constexpr (Law::tangential) *history = {spring, stamp};
  return f;
}

// The distance of two spheres is formed in double: overlaps are 1e-4 radii and the difference of two large
// coordinates.
template <class Real>
struct Approach {
  Vec3d d;       // from the neighbour's centre to ours [m]
  double d2;     // |d|^2 [m2]
  double reach;  // sum of the radii [m]

  TANDEM_HD Approach(const Place<Real>& own, const Place<Real>& other)
      : d(own.x - other.x),
        d2(norm2(d)),
        reach(static_cast<double>(own.radius) + static_cast<double>(other.radius)) {}
  // Two spheres in one point have no direction; the start is checked for such.
  TANDEM_HD bool touching() const { return d2 < reach * reach && d2 != 0; }
};

// The forces of all neighbours on sphere i.
template <class Law, class Real>
struct PairForces {
  const View<Real>& view;
  const Control& c;
  const Place<Real>& own;
  const Motion<Real>& motion;
  const ListView<Real>& list = view.pairs[c.list_side];
  const Place<Real>* place = view.place[c.state_side];
  const Motion<Real>* motions = view.motion[c.state_side];

  TANDEM_HD bool touches(std::uint32_t k) const {
    return Approach<Real>(own, fetch(place + fetch(list.entry + k))).touching();
  }

  // Adds the force that neighbour entry k exerts.
  TANDEM_HD void add(std::uint32_t k, ForceSum<Real>& sum) const {
    const std::uint32_t j = fetch(list.entry + k);
    const Place<Real> other = fetch(place + j);
    const Motion<Real> other_motion = fetch(motions + j);
    const Parameters<Real>& p = view.parameters;
    const Approach<Real> a(own, other);
    const Real distance = std::sqrt(static_cast<Real>(a.d2));
    Contact<Real> contact;
    contact.n = (Real(1) / distance) * a.d.template as<Real>();
    // reach - distance without cancellation.
    contact.overlap = static_cast<Real>(a.reach * a.reach - a.d2) / (static_cast<Real>(a.reach) + distance);
    const Real arm = own.radius - contact.overlap / 2, other_arm = other.radius - contact.overlap / 2;
    Vec3<Real> u = (motion.v - other_motion.v).template as<Real>();
    if constexpr (Law::tangential) u -= cross(arm * motion.w + other_arm * other_motion.w, contact.n);
    contact.normal_speed = dot(u, contact.n);
    contact.slip = u - contact.normal_speed * contact.n;
    contact.dt = static_cast<Real>(c.dt);

    const ContactForce<Real> f = contact_force<Law>(contact, p.between(own, other), p.law,
                                                    Law::tangential ? list.history + k : nullptr, c.stamp);
    sum.force += (f.normal * contact.n + f.tangential).template as<double>();
    if constexpr (Law::tangential) sum.torque += arm * cross(f.tangential, contact.n);
    sum.see_overlap(contact.overlap, own.radius < other.radius ? own.radius : other.radius);
  }
};

}  // namespace tandem::dem
