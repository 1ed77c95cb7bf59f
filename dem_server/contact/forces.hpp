// The force on one sphere: gathered from its neighbours and from the walls near it. Each sphere owns its contacts, so
// nothing is added atomically between spheres; a pair is evaluated from both sides with bitwise opposite results.
#pragma once

#include "dem_server/geometry/facet_contact.hpp"
#include "dem_server/model/view.hpp"

namespace tandem::dem {

// Sum over contacts; double, so that opposite forces cancel to the rounding of the state.
struct ForceSum {
  Vec3d force;            // [N]
  Vec3d torque;           // about the centre [N m]
  float max_overlap_ratio = 0;

  TANDEM_HD ForceSum& operator+=(const ForceSum& b) {
    force += b.force;
    torque += b.torque;
    if (b.max_overlap_ratio > max_overlap_ratio) max_overlap_ratio = b.max_overlap_ratio;
    return *this;
  }
#if defined(__CUDACC__)
  __device__ void shuffle_add(unsigned group, int distance) {
    ForceSum b;
    b.force = {__shfl_xor_sync(group, force.x, distance), __shfl_xor_sync(group, force.y, distance),
               __shfl_xor_sync(group, force.z, distance)};
    b.torque = {__shfl_xor_sync(group, torque.x, distance), __shfl_xor_sync(group, torque.y, distance),
                __shfl_xor_sync(group, torque.z, distance)};
    b.max_overlap_ratio = __shfl_xor_sync(group, max_overlap_ratio, distance);
    *this += b;
  }
#endif
};

template <class Real>
TANDEM_HD Real mass_of(const Parameters<Real>& p, const Place<Real>& s) {
  return p.mass_per_volume[s.material] * s.radius * s.radius * s.radius;
}

// Evaluates the law with the contact's history, which a law without friction has not.
template <class Law, class Real>
TANDEM_HD ContactForce<Real> contact_force(const Contact<Real>& c, const PairConstants<Real>& pair, std::uint32_t law,
                                           History<Real>* history, std::uint32_t stamp) {
  Vec3<Real> spring;
  if constexpr (Law::tangential) {
    const History<Real> h = *history;
    // Touched in the last step: the contact goes on. Otherwise it is new.
    if (h.stamp == stamp - 1) spring = h.spring;
  }
  const ContactForce<Real> f = Law{}(c, pair, law, spring);
  if constexpr (Law::tangential) *history = {spring, stamp};
  return f;
}

// Adds the force that neighbour entry k exerts on sphere `own`.
template <class Law, class Real>
TANDEM_HD void add_pair(const View<Real>& view, const Control& c, std::uint32_t k, const Place<Real>& own,
                        const Motion<Real>& own_motion, ForceSum& sum) {
  const ListView<Real>& list = view.pairs[c.list_side];
  const std::uint32_t j = list.entry[k];
  const Place<Real> other = view.place[c.state_side][j];
  // The distance is formed in double: overlaps are 1e-4 radii and the difference of two large coordinates.
  const Vec3d d = own.x - other.x;
  const double reach = static_cast<double>(own.radius) + static_cast<double>(other.radius);
  const double d2 = norm2(d), gap2 = reach * reach - d2;
  if (gap2 <= 0 || d2 == 0) return;

  const Motion<Real> other_motion = view.motion[c.state_side][j];
  const Real distance = std::sqrt(static_cast<Real>(d2));
  Contact<Real> contact;
  contact.n = (Real(1) / distance) * d.template as<Real>();
  // reach - distance without cancellation.
  contact.overlap = static_cast<Real>(gap2) / (static_cast<Real>(reach) + distance);
  const Real arm = own.radius - contact.overlap / 2, other_arm = other.radius - contact.overlap / 2;
  Vec3<Real> u = (own_motion.v - other_motion.v).template as<Real>();
  if constexpr (Law::tangential) u -= cross(arm * own_motion.w + other_arm * other_motion.w, contact.n);
  contact.normal_speed = dot(u, contact.n);
  contact.slip = u - contact.normal_speed * contact.n;
  const Parameters<Real>& p = *view.parameters;
  const Real m = mass_of(p, own), other_m = mass_of(p, other);
  contact.r_eff = own.radius * other.radius / (own.radius + other.radius);
  contact.m_eff = m * other_m / (m + other_m);
  contact.dt = static_cast<Real>(c.dt);

  const ContactForce<Real> f =
      contact_force<Law>(contact, p.pair[own.material * max_materials + other.material], p.law,
                         Law::tangential ? list.history + k : nullptr, c.stamp);
  sum.force += (f.normal * contact.n + f.tangential).template as<double>();
  if constexpr (Law::tangential) sum.torque += (arm * cross(f.tangential, contact.n)).template as<double>();
  const Real smaller = own.radius < other.radius ? own.radius : other.radius;
  const float ratio = static_cast<float>(contact.overlap / smaller);
  if (ratio > sum.max_overlap_ratio) sum.max_overlap_ratio = ratio;
}

// The history of a wall contact lives at the first entry of its patch in the sphere's list. A contact that is new
// under its patch has crossed an edge if the neighbouring patch was touched in the last step: it goes on with that
// history.
template <class Real>
TANDEM_HD History<Real>* wall_history(const View<Real>& view, const ListView<Real>& list, std::uint32_t begin,
                                      std::uint32_t end, const WallContact& contact, std::uint32_t stamp) {
  History<Real>*own = nullptr, *neighbour = nullptr;
  for (std::uint32_t k = begin; k < end; ++k) {
    const std::uint32_t patch = view.facets[list.entry[k]].patch;
    if (patch == contact.patch && own == nullptr) own = list.history + k;
    if (patch == contact.neighbour && neighbour == nullptr) neighbour = list.history + k;
  }
  if (own->stamp != stamp - 1 && neighbour->stamp == stamp - 1) {
    *own = *neighbour;
    neighbour->stamp = 0;
  }
  return own;
}

// The forces of all walls near sphere i; their reactions are booked on the bodies.
template <class Law, class Real, class Tally>
TANDEM_HD TANDEM_NOINLINE ForceSum wall_forces(const View<Real>& view, std::uint32_t i, Place<Real> own,
                                               Motion<Real> motion, Tally& tally) {
  ForceSum sum;
  const Control& c = *view.control;
  const ListView<Real>& list = view.walls[c.list_side];
  const Parameters<Real>& p = *view.parameters;
  const std::uint32_t end = list.start[i + 1];
  for (std::uint32_t first = list.start[i], next; first < end; first = next) {
    const std::uint32_t slot = view.patches[view.facets[list.entry[first]].patch].slot;
    next = first + 1;
    while (next < end && view.patches[view.facets[list.entry[next]].patch].slot == slot) ++next;

    const BodyPose& body = view.pose[c.step * view.slots + slot];
    const Vec3d centre = body.R.transpose_times(own.x - body.p);
    UninitialisedArray<WallContact, max_wall_contacts> found;
    const int contacts =
        collect_wall_contacts(centre, static_cast<double>(own.radius), list.entry + first,
                              static_cast<int>(next - first), view.facets, found.data(), max_wall_contacts);
    if (contacts == wall_contact_overflow) tally.raise(wall_contacts_overflow, motion.id);
    for (int w = 0; w < contacts; ++w) {
      const Patch& patch = view.patches[found[w].patch];
      const Vec3d n = body.R * found[w].normal, arm_body = body.R * found[w].point;
      Contact<Real> contact;
      contact.n = n.template as<Real>();
      contact.overlap = static_cast<Real>(-found[w].gap);
      const Real arm = own.radius - contact.overlap;
      Vec3<Real> u = (motion.v - body.v - cross(body.w, arm_body)).template as<Real>();
      if constexpr (Law::tangential) u -= cross(arm * motion.w, contact.n);
      contact.normal_speed = dot(u, contact.n);
      contact.slip = u - contact.normal_speed * contact.n;
      contact.r_eff = own.radius;       // a flat wall has no curvature,
      contact.m_eff = mass_of(p, own);  // and follows a path that this contact does not change within the step
      contact.dt = static_cast<Real>(c.dt);

      History<Real>* history = nullptr;
      if constexpr (Law::tangential) history = wall_history(view, list, first, next, found[w], c.stamp);
      const ContactForce<Real> f = contact_force<Law>(
          contact, p.pair[own.material * max_materials + patch.material], p.law, history, c.stamp);
      const Vec3d exact = (f.normal * contact.n + f.tangential).template as<double>();
      if (!(norm2(exact) < p.force_limit * p.force_limit)) tally.raise(force_range, motion.id);
      // Rounded once, so that the sphere loses exactly what the body is booked to gain.
      const Vec3d force = rounded(exact, p.force);
      sum.force += force;
      if constexpr (Law::tangential) sum.torque += (arm * cross(f.tangential, contact.n)).template as<double>();
      tally.add_load(slot, -force, cross(arm_body, -force), p.force, p.torque);
      const float ratio = static_cast<float>(contact.overlap / own.radius);
      if (ratio > sum.max_overlap_ratio) sum.max_overlap_ratio = ratio;
    }
  }
  return sum;
}

}  // namespace tandem::dem
