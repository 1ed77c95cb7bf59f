// The forces of walls on the spheres near them. A pass of its own over a compact list: few spheres are near a
// wall, and what their geometry needs of registers and stack would slow down all others.
#pragma once

#include "dem_server/contact/pair_forces.hpp"
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

// Finds the force and torque that a body's walls exert on a sphere near them, and books the reaction on the
// body. A group of threads shares this: each tests other facets and evaluates another contact.
template <class Law, class Real>
struct WallForces {
  View<Real> view;

  template <class Group, class Tally>
  TANDEM_HD void operator()(const Instant& now, std::uint32_t which, const Group& group,
                            WallContactSpace& space, Tally& tally) const {
    const NearBody near = fetch(view.near + which);
    const Place<Real> place = fetch(view.place[now.state_side] + near.sphere);
    const Vec3d x = fetch(&view.exact[now.list_side][near.sphere].x);
    const BodyPose& body = view.pose[now.step * view.slots + near.slot];
    const ListView<Real>& list = view.walls[now.list_side];
    const std::uint32_t end = near.first + near.count;
    const Vec3d centre = body.R.transpose_times(x - body.p);
    int contacts = 0;
    if (!is_parked(place))
      contacts = collect_wall_contacts(group, centre, view.parameters.unit.exact_metres(place.radius),
                                       list.entry + near.first, static_cast<int>(near.count), view.facets,
                                       space);
    if (contacts == wall_contact_overflow) {
      tally.raise(wall_contacts_overflow, view.id[now.list_side][near.sphere]);
      contacts = 0;
    }
    if constexpr (Law::tangential) {
      for (int w = 0; w < contacts; ++w) {
        const std::uint32_t k =
            wall_history(group, view.facets, list, near.first, end, space.contacts[w], now.stamp);
        if (group.leads()) space.history[w] = k;
      }
      group.sync();
    }
    WallForce<Real> sum;
    group.add_in_order(sum, contacts, [&](int w) {
      return force_of(now, near, body, space.contacts[w],
                      Law::tangential ? list.history + space.history[w] : nullptr, view.parameters.radius(place),
                      tally);
    });
    if (group.leads()) view.wall_force[which] = sum;
    group.sync();  // before `space` is used again
  }

 private:
  template <class Tally>
  TANDEM_HD WallForce<Real> force_of(const Instant& now, const NearBody& near, const BodyPose& body,
                                     const WallContact& wall, History<Real>* history, Real radius,
                                     Tally& tally) const {
    const Parameters<Real>& p = view.parameters;
    const Vec3d v = fetch(&view.exact[now.list_side][near.sphere].v);
    const Vec3d n = body.R * wall.normal, arm_body = body.R * wall.point;
    Contact<Real> contact;
    contact.n = n.template as<Real>();
    contact.overlap = static_cast<Real>(-wall.gap);
    const Real arm = radius - contact.overlap;
    Vec3<Real> u = (v - body.v - cross(body.w, arm_body)).template as<Real>();
    if constexpr (Law::tangential)
      u -= cross(arm * fetch(view.spin[now.state_side] + near.sphere).w, contact.n);
    contact.normal_speed = dot(u, contact.n);
    contact.slip = u - contact.normal_speed * contact.n;
    contact.dt = static_cast<Real>(now.dt);

    const std::uint32_t kind = fetch(&view.drift[now.state_side][near.sphere].kind);
    const ContactForce<Real> f =
        contact_force<Law>(contact, p.with_wall(kind, radius, view.patches[wall.patch].material), p.law,
                           history, now.stamp);
    const Vec3d exact = (f.normal * contact.n + f.tangential).template as<double>();
    if (!(norm2(exact) < p.force_limit * p.force_limit))
      tally.raise(force_range, view.id[now.list_side][near.sphere]);
    WallForce<Real> on_sphere;
    // Rounded once, so that the sphere loses exactly what the body is booked to gain.
    on_sphere.force = rounded(exact, p.force);
    if constexpr (Law::tangential) on_sphere.torque = arm * cross(f.tangential, contact.n);
    tally.add_load(near.slot, -on_sphere.force, cross(arm_body, -on_sphere.force), p.force, p.torque);
    tally.observe_overlap(static_cast<float>(contact.overlap / radius));
    return on_sphere;
  }
};

}  // namespace tandem::dem
