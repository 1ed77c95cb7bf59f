// The forces of walls on the spheres near them. A pass of its own over a compact list: few spheres are near a
// wall, and what their geometry needs of registers and stack would slow down all others.
#pragma once

#include "dem_server/contact/forces.hpp"
#include "dem_server/geometry/facet_contact.hpp"

namespace tandem::dem {

// The history of a wall contact lives at the first entry of its patch in the sphere's list. A contact that is
// new under its patch has crossed an edge if the neighbouring patch was touched in the last step: it goes on
// with that history.
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

// Finds the force and torque of all walls on the near-th of the spheres near walls, and books the reactions
// on the bodies.
template <class Law, class Real>
struct WallForces {
  View<Real> view;

  template <class Tally>
  TANDEM_HD void operator()(const Control& c, std::uint32_t near, Tally& tally) const {
    const std::uint32_t i = view.near[near];
    const Place<Real> own = view.place[c.state_side][i];
    const Motion<Real> motion = view.motion[c.state_side][i];
    ForceSum<Real> sum;
    if (!is_parked(own.x)) {
      const ListView<Real>& list = view.walls[c.list_side];
      const std::uint32_t end = list.start[i + 1];
      for (std::uint32_t first = list.start[i], next; first < end; first = next) {
        // Entries of one body are neighbours in the list.
        const std::uint32_t slot = slot_of(list, first);
        for (next = first + 1; next < end && slot_of(list, next) == slot;) ++next;
        add_body(c, slot, first, next, own, motion, sum, tally);
      }
    }
    view.wall_force[near] = {sum.force, sum.torque};
    tally.observe(0, sum.max_overlap_ratio);
  }

 private:
  TANDEM_HD std::uint32_t slot_of(const ListView<Real>& list, std::uint32_t k) const {
    return view.patches[view.facets[list.entry[k]].patch].slot;
  }

  template <class Tally>
  TANDEM_HD void add_body(const Control& c, std::uint32_t slot, std::uint32_t first, std::uint32_t next,
                          const Place<Real>& own, const Motion<Real>& motion, ForceSum<Real>& sum,
                          Tally& tally) const {
    const ListView<Real>& list = view.walls[c.list_side];
    const Parameters<Real>& p = view.parameters;
    const BodyPose& body = view.pose[c.step * view.slots + slot];
    const Vec3d centre = body.R.transpose_times(own.x - body.p);
    UninitialisedArray<WallContact, max_wall_contacts> found;
    const int contacts =
        collect_wall_contacts(centre, static_cast<double>(own.radius), list.entry + first,
                              static_cast<int>(next - first), view.facets, found.data(), max_wall_contacts);
    if (contacts == wall_contact_overflow) tally.raise(wall_contacts_overflow, motion.id);
    for (int w = 0; w < contacts; ++w) {
      const Vec3d n = body.R * found[w].normal, arm_body = body.R * found[w].point;
      Contact<Real> contact;
      contact.n = n.template as<Real>();
      contact.overlap = static_cast<Real>(-found[w].gap);
      const Real arm = own.radius - contact.overlap;
      Vec3<Real> u = (motion.v - body.v - cross(body.w, arm_body)).template as<Real>();
      if constexpr (Law::tangential) u -= cross(arm * motion.w, contact.n);
      contact.normal_speed = dot(u, contact.n);
      contact.slip = u - contact.normal_speed * contact.n;
      contact.dt = static_cast<Real>(c.dt);

      History<Real>* history = nullptr;
      if constexpr (Law::tangential) history = wall_history(view, list, first, next, found[w], c.stamp);
      const ContactForce<Real> f = contact_force<Law>(
          contact, p.with_wall(own, view.patches[found[w].patch].material), p.law, history, c.stamp);
      const Vec3d exact = (f.normal * contact.n + f.tangential).template as<double>();
      if (!(norm2(exact) < p.force_limit * p.force_limit)) tally.raise(force_range, motion.id);
      // Rounded once, so that the sphere loses exactly what the body is booked to gain.
      const Vec3d force = rounded(exact, p.force);
      sum.force += force;
      if constexpr (Law::tangential) sum.torque += arm * cross(f.tangential, contact.n);
      tally.add_load(slot, -force, cross(arm_body, -force), p.force, p.torque);
      sum.see_overlap(contact.overlap, own.radius);
    }
  }
};

}  // namespace tandem::dem
