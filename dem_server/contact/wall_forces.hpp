// The forces of walls on the spheres near them. A pass of its own over a compact list: few spheres are near a
// wall, and what their geometry needs of registers and stack would slow down all others.
#pragma once

#include "dem_server/contact/forces.hpp"
#include "dem_server/geometry/facet_contact.hpp"

namespace tandem::dem {

// The history of a wall contact lives at the first entry of its patch in the sphere's list. A contact that is
// new under its patch has crossed an edge if the neighbouring patch was touched in the last step: it goes on
// with that history.
template <class Group, class Real>
TANDEM_HD std::uint32_t wall_history(const Group& group, const Facet* facets, const ListView<Real>& list,
                                     std::uint32_t begin, std::uint32_t end, const WallContact& contact,
                                     std::uint32_t stamp) {
  const auto first_of = [&](std::uint32_t patch) {
    return group.find(begin, end, [&](std::uint32_t k) { return facets[list.entry[k]].patch == patch; });
  };
  const std::uint32_t own = first_of(contact.patch);
  if (contact.neighbour == contact.patch) return own;
  const std::uint32_t neighbour = first_of(contact.neighbour);
  History<Real>*to = list.history + own, *from = list.history + neighbour;
  if (group.leads() && to->stamp != stamp - 1 && from->stamp == stamp - 1) {
    *to = *from;
    from->stamp = 0;
  }
  return own;
}

// Finds the force and torque of all walls on the near-th of the spheres near walls, and books the reactions
// on the bodies. A group of threads shares a sphere: each tests other facets and evaluates another contact.
template <class Law, class Real>
struct WallForces {
  View<Real> view;

  template <class Group, class Tally>
  TANDEM_HD void operator()(const Control& c, std::uint32_t near, const Group& group, WallContactSpace& space,
                            Tally& tally) const {
    const std::uint32_t i = view.near[near];
    const Place<Real> own = fetch(view.place[c.state_side] + i);
    const Motion<Real> motion = fetch(view.motion[c.state_side] + i);
    ForceSum<Real> sum;
    if (!is_parked(own.x)) {
      const ListView<Real>& list = view.walls[c.list_side];
      const std::uint32_t end = list.start[i + 1];
      for (std::uint32_t first = list.start[i], next; first < end; first = next) {
        // Entries of one body are neighbours in the list.
        const std::uint32_t slot = view.facets[list.entry[first]].slot;
        next = group.find(first + 1, end,
                          [&](std::uint32_t k) { return view.facets[list.entry[k]].slot != slot; });
        add_body(c, slot, first, next, own, motion, group, space, sum, tally);
      }
    }
    if (!group.leads()) return;
    view.wall_force[near] = {sum.force, sum.torque};
    tally.observe(0, sum.max_overlap_ratio);
  }

 private:
  template <class Group, class Tally>
  TANDEM_HD void add_body(const Control& c, std::uint32_t slot, std::uint32_t first, std::uint32_t next,
                          const Place<Real>& own, const Motion<Real>& motion, const Group& group,
                          WallContactSpace& space, ForceSum<Real>& sum, Tally& tally) const {
    const ListView<Real>& list = view.walls[c.list_side];
    const BodyPose& body = view.pose[c.step * view.slots + slot];
    const Vec3d centre = body.R.transpose_times(own.x - body.p);
    const int contacts =
        collect_wall_contacts(group, centre, static_cast<double>(own.radius), list.entry + first,
                              static_cast<int>(next - first), view.facets, space);
    if (contacts == wall_contact_overflow) {
      tally.raise(wall_contacts_overflow, motion.id);
      return;
    }
    if constexpr (Law::tangential) {
      for (int w = 0; w < contacts; ++w) {
        const std::uint32_t k =
            wall_history(group, view.facets, list, first, next, space.contacts[w], c.stamp);
        if (group.leads()) space.history[w] = k;
      }
      group.sync();
    }
    group.add_in_order(sum, contacts, [&](int w) {
      return force_of(c, slot, body, space.contacts[w],
                      Law::tangential ? list.history + space.history[w] : nullptr, own, motion, tally);
    });
    group.sync();  // before `space` is used again
  }

  template <class Tally>
  TANDEM_HD ForceSum<Real> force_of(const Control& c, std::uint32_t slot, const BodyPose& body,
                                    const WallContact& wall, History<Real>* history, const Place<Real>& own,
                                    const Motion<Real>& motion, Tally& tally) const {
    const Parameters<Real>& p = view.parameters;
    const Vec3d n = body.R * wall.normal, arm_body = body.R * wall.point;
    Contact<Real> contact;
    contact.n = n.template as<Real>();
    contact.overlap = static_cast<Real>(-wall.gap);
    const Real arm = own.radius - contact.overlap;
    Vec3<Real> u = (motion.v - body.v - cross(body.w, arm_body)).template as<Real>();
    if constexpr (Law::tangential) u -= cross(arm * motion.w, contact.n);
    contact.normal_speed = dot(u, contact.n);
    contact.slip = u - contact.normal_speed * contact.n;
    contact.dt = static_cast<Real>(c.dt);

    const ContactForce<Real> f = contact_force<Law>(
        contact, p.with_wall(own, view.patches[wall.patch].material), p.law, history, c.stamp);
    const Vec3d exact = (f.normal * contact.n + f.tangential).template as<double>();
    if (!(norm2(exact) < p.force_limit * p.force_limit)) tally.raise(force_range, motion.id);
    ForceSum<Real> sum;
    // Rounded once, so that the sphere loses exactly what the body is booked to gain.
    sum.force = rounded(exact, p.force);
    if constexpr (Law::tangential) sum.torque = arm * cross(f.tangential, contact.n);
    tally.add_load(slot, -sum.force, cross(arm_body, -sum.force), p.force, p.torque);
    sum.see_overlap(contact.overlap, own.radius);
    return sum;
  }
};

}  // namespace tandem::dem
