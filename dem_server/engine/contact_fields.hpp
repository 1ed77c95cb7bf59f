// Number and mean stress of the contacts of each sphere, for a frame. They follow from the state between two
// windows and change nothing in it, so that runs with and without them have the same bits.
//
// The mean normal stress in a sphere of volume V, positive in compression, is a third of the trace of its
// mean stress tensor [Christoffersen1981],
//   p = 1/(3 V) sum of F_n l
// over its contacts, with normal force F_n, positive where it pushes, and distance l of the contact from the
// centre. Friction is perpendicular to the line to the centre and adds nothing. Forces are those of the micro
// step that comes next: of these positions, and of velocities half a micro step before.
//
// The contacts of single bodies are evaluated in the same way.
#pragma once

#include "dem_server/contact/pair_forces.hpp"
#include "dem_server/engine/engine.hpp"
#include "dem_server/engine/interface_stiffness.hpp"
#include "dem_server/engine/sphere_contacts.hpp"

namespace tandem::dem {

// Evaluates the listed pairs of sphere i.
template <class Law, class Real>
struct FindNormalForces {
  View<Real> view;
  PairNormalForce<Real>* of_pair;  // of each entry
  double dt;                       // [s]

  TANDEM_HD void operator()(std::uint32_t i) const {
    const WindowProgress& c = *view.window;
    const CurrentStep now(dt, c.progress[0]);
    const PairForces<Law, Real> pairs{view, now, StateInMemory<Real>(view, now)};
    for (std::uint32_t k = view.lists.pairs.start[i]; k < view.lists.pairs.start[i + 1]; ++k)
      of_pair[k] = of(pairs, i, k);
  }

 private:
  TANDEM_HD PairNormalForce<Real> of(const PairForces<Law, Real>& pairs, std::uint32_t i,
                                     std::uint32_t k) const {
    const Parameters<Real>& p = view.parameters;
    TouchingPair<Real> m;
    if (!pairs.find_touching(i, k, m)) return {};
    Vec3<Real> spring;  // the normal force does not depend on it
    Contact<Real> c;
    if constexpr (Law::extended) {
      const Neighbour neighbour = view.lists.pairs.entry[k];
      c = contact_of<Law>(m, p.unit, p.unit.metres(p.range), static_cast<Real>(dt));
      extend(view, c, p.material(pairs.state.kind(i)), m.radius,
             p.material(pairs.state.kind(neighbour.index())), m.other_radius);
      if (!Law::in_contact(c, m.k, p.law, neighbour.in_contact())) return {};
    } else {
      c = contact_of<Law>(m, p.unit, Real(0), static_cast<Real>(dt));
    }
    return {Law{}(c, m.k, p.law, spring).normal, c.overlap, 1};
  }
};

// Sums over the contacts of sphere i, in the order of the force sums (contact/pair_sum.hpp), walls last.
template <class Law, class Real, bool pairs_once>
struct SumContacts {
  View<Real> view;
  const PairNormalForce<Real>* of_pair;
  const BodyPose* pose;  // of each body
  double dt;             // [s]
  SphereContacts* result;

  TANDEM_HD void operator()(std::uint32_t i) const {
    const WindowProgress& c = *view.window;
    const CurrentStep now(dt, c.progress[0]);
    const PositionRadius<Real> position = view.spheres.position[now.state_side][i];
    SphereContacts sum;
    if (!is_parked(position)) {
      const double radius = view.parameters.unit.exact_metres(position.radius);
      double virial = 0;  // sum of F_n l [N m]
      const auto add = [&](const PairNormalForce<Real>& pair) {
        if (pair.touching == 0) return;
        ++sum.count;
        virial += static_cast<double>(pair.normal) * (radius - static_cast<double>(pair.overlap) / 2);
      };
      for (std::uint32_t k = view.lists.pairs.start[i]; k < view.lists.pairs.start[i + 1]; ++k)
        add(of_pair[k]);
      if constexpr (pairs_once)
        for (std::uint32_t m = view.lists.mirror_start[i]; m < view.lists.mirror_start[i + 1]; ++m)
          add(of_pair[view.lists.mirror[m]]);
      const WallTangents<Law, Real> walls{view, pose, now};
      const Range near = view.near_of(i, view.spheres.velocity[now.state_side][i].label);
      for (std::uint32_t which = near.begin; which < near.end; ++which)
        walls.each_contact(which, [&](const WallContactState& contact) {
          Vec3d spring;
          ++sum.count;
          virial += Law{}(contact.contact, contact.k, view.parameters.law, spring).normal *
                    (radius - contact.contact.overlap);
        });
      constexpr double four_pi = 12.566370614359172;
      sum.mean_stress = virial / (four_pi * radius * radius * radius);
    }
    result[i] = sum;
  }
};

// The contacts of entry `which` of the pairs of a sphere and a body near it. Without `found` they are counted
// into start[which], else stored from that index on.
template <class Law, class Real>
struct FindBodyContacts {
  View<Real> view;
  const BodyPose* pose;        // of each body
  const std::uint8_t* wanted;  // of each body
  double dt;                   // [s]
  std::uint32_t* start;
  BodyContact* found;

  TANDEM_HD void operator()(std::uint32_t which) const {
    const NearBody near = view.lists.near[which];
    std::uint32_t count = 0;
    if (wanted[near.body] != 0) {
      const CurrentStep now(dt, view.window->progress[0]);
      const WallTangents<Law, Real> walls{view, pose, now};
      const Vec3d origin = pose[near.body].p;
      std::uint32_t id = 0;
      if constexpr (Law::tangential)
        id = view.spheres.spin[now.state_side][near.sphere].id;
      else
        id = view.spheres.id[near.sphere];
      walls.each_contact(which, [&](const WallContactState& at) {
        if (found != nullptr) {
          Vec3d spring = at.spring;
          const ContactForce<double> f = Law{}(at.contact, at.k, view.parameters.law, spring);
          found[start[which] + count] = {near.body, id, origin + at.arm,
                                         -(f.normal * at.contact.n + f.tangential)};
        }
        ++count;
      });
    }
    if (found == nullptr) start[which] = count;
  }
};

}  // namespace tandem::dem
