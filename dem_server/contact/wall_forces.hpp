// Forces of walls on the spheres near them. They are computed in a separate pass over a compact list: few
// spheres are near a wall, and the registers and stack of the wall geometry would slow down all others.
#pragma once

#include "dem_server/contact/pair_forces.hpp"
#include "dem_server/contact/wall_curvature.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/geometry/facet_contact.hpp"

namespace tandem::dem {

// The history of a wall contact is stored in the first entry of its patch in the sphere's list. If a contact
// is new under its patch, but the neighbouring patch was in contact in the last step, the sphere has crossed
// an edge and the contact continues with that history.
template <bool rolls, class Real>
TANDEM_HD History<Real>* wall_history(const Facet* facets, const WallList<Real>& list, std::uint32_t first,
                                      const WallContact& contact, std::uint32_t stamp) {
  const auto of = [&](std::uint32_t patch) {
    std::uint32_t k = first;
    while (facets[list.entry[k]].patch != patch) ++k;
    return list.history + k;
  };
  History<Real>* own = of(contact.patch);
  if (contact.neighbour == contact.patch) return own;
  History<Real>* neighbour = of(contact.neighbour);
  if (own->stamp != stamp - 1 && neighbour->stamp == stamp - 1) {
    *own = *neighbour;
    if constexpr (rolls)
      if (list.rolling != nullptr) list.rolling[own - list.history] = list.rolling[neighbour - list.history];
    neighbour->stamp = 0;
  }
  return own;
}

// Evaluates the law with the contact's history; a law without friction has none.
template <class Law, class Real>
TANDEM_HD ContactForce<Real> contact_force(const Contact<Real>& c, const Coefficients<Real>& k,
                                           std::uint32_t law, History<Real>* history, std::uint32_t stamp) {
  Vec3<Real> spring;
  if constexpr (Law::tangential) {
    const History<Real> h = *history;
    // In contact in the last step: the contact continues. Otherwise it is new.
    if (h.stamp == stamp - 1) spring = h.spring;
  }
  const ContactForce<Real> f = Law{}(c, k, law, spring);
  if constexpr (Law::tangential) *history = {spring, stamp};
  return f;
}

// Computes the force and torque of a body's walls on a sphere near them, and adds the reaction to the load of
// the body.
template <class Law, class Real, class State = StateInMemory<Real>>
struct WallForces {
  const View<Real>& view;
  const CurrentStep& now;
  State state;

  // Computes and stores the force by the rule for few contacts. Returns false, and stores nothing, where the
  // rule for any number of contacts is needed.
  template <class Tally>
  TANDEM_HD bool compute_few_contacts(std::uint32_t which, Tally& tally) const {
    const SphereNearBody m(view, now, state, which);
    FewWallContacts found;
    const int contacts =
        m.parked ? 0
                 : collect_few_wall_contacts(m.centre, m.exact_radius, m.facets(),
                                             static_cast<int>(m.near.count), view.surface.facets, found);
    if (contacts == needs_general_rule) return false;
    WallForce<Real> sum;
    for (int w = 0; w < contacts; ++w) {
      if (w > 0) found.a = w == 1 ? found.b : found.c;
      sum += force_of(m, found.a, tally);
    }
    state.set_wall_force(which, sum);
    return true;
  }

  // Is the sphere in contact with the facet of wall entry k, and how?
  TANDEM_HD bool touches(std::uint32_t which, std::uint32_t k, WallContact& touch) const {
    const SphereNearBody m(view, now, state, which);
    return !m.parked &&
           touch_facet(view.surface.facets, fetch(m.list.entry + k), m.centre, m.exact_radius, touch);
  }

  // The same by the rule for any number of contacts.
  template <class Tally>
  TANDEM_HD void compute_any_contacts(std::uint32_t which, WallContactSpace& space, Tally& tally) const {
    const SphereNearBody m(view, now, state, which);
    const int contacts = collect_wall_contacts(m.centre, m.exact_radius, m.facets(),
                                               static_cast<int>(m.near.count), view.surface.facets, space);
    if (contacts == wall_contact_overflow) tally.raise(wall_contacts_overflow, m.id());
    WallForce<Real> sum;
    for (int w = 0; w < contacts; ++w) sum += force_of(m, space.contacts[w], tally);
    state.set_wall_force(which, sum);
  }

 private:
  // A sphere and a body near it at one instant.
  struct SphereNearBody {
    const View<Real>& view;
    const CurrentStep& now;
    const State& state;
    NearBody near;
    const WallList<Real>& list;
    PositionRadius<Real> position;
    FinePart<Real> fine;
    VelocityKind<Real> velocity;
    Spin<Real> spin;  // only for laws with friction
    const BodyPose& body;
    Vec3d centre;         // of the sphere, body frame [m]
    double exact_radius;  // plus the range of adhesion [m]
    bool parked;

    TANDEM_HD SphereNearBody(const View<Real>& in, const CurrentStep& at, const State& where,
                             std::uint32_t which)
        : view(in),
          now(at),
          state(where),
          near(fetch(view.lists.near + which)),
          list(view.lists.walls),
          position(state.position(near.sphere)),
          fine(state.fine(near.sphere)),
          velocity(state.velocity(near.sphere)),
          spin(Law::tangential ? state.spin(near.sphere) : Spin<Real>{}),
          body(view.pose[now.step * view.surface.bodies + near.body]),
          centre(body.R.transpose_times(x() - body.p)),
          exact_radius(view.parameters.unit.exact_metres(position.radius) + range()),
          parked(is_parked(position)) {}
    TANDEM_HD Vec3d x() const { return view.parameters.centre(position, fine); }
    TANDEM_HD Vec3d v() const { return velocity_of(velocity, fine); }
    TANDEM_HD std::uint32_t kind() const { return velocity.kind(); }
    TANDEM_HD auto facets() const { return state.facets(near.first, now); }
    TANDEM_HD std::uint32_t id() const { return Law::tangential ? spin.id : view.spheres.id[near.sphere]; }
    TANDEM_HD double range() const {
      if constexpr (Law::extended)
        return view.parameters.unit.exact_metres(view.parameters.range);
      else
        return 0;
    }
  };

  // Index of the body in an array (steps x bodies).
  TANDEM_HD std::size_t place_of(const SphereNearBody& m) const {
    return std::size_t{now.step} * view.surface.bodies + m.near.body;
  }
  // Most scenes have no belts. Their variants contain nothing of them, because even a branch that is never
  // taken makes the micro steps of small scenes on a GPU longer.
  TANDEM_HD bool has_belts() const {
    if constexpr (Law::belts)
      return view.belts.any();
    else
      return false;
  }
  // Velocity of the surface at a contact: across the normal, so that no end face of a belt pushes.
  TANDEM_HD Vec3d belt_velocity(const SphereNearBody& m, Vec3d n) const {
    const Vec3d v = m.body.R * view.belts.velocity[place_of(m)];
    return v - dot(v, n) * n;
  }
  TANDEM_HD void add_pull(const SphereNearBody& m, Vec3d on_sphere) const {
    const Vec3d v = view.belts.velocity[place_of(m)];
    if (norm2(v) == 0) return;
    const double along = dot(on_sphere, m.body.R * v) / norm(v);
    add_shared(view.belts.pull + place_of(m), to_fixed(-along, view.parameters.force));
  }

  // Sliding is the part of the displacement that the spring does not keep. What presses the surfaces on each
  // other is the elastic force, as in Coulomb's law; the damping force acts inside the spheres.
  TANDEM_HD void add_to_sums(const WallContact& wall, const Contact<Real>& c, const ContactForce<Real>& f,
                             Vec3d on_sphere, Vec3<Real> spring_before, Vec3<Real> spring, Real wear) const {
    const Vec3<Real> slid =
        rotate_spring(spring_before, c, f.previous_stiffness2, f.current_stiffness2) + c.dt * c.slip - spring;
    const auto path = static_cast<double>(norm(slid));
    WallContribution add;
    add.force = -on_sphere;
    add.normal = static_cast<double>(f.normal);
    add.shear = static_cast<double>(norm(f.tangential));
    add.friction_work = add.shear * path;
    if (f.elastic_force > 0)
      add.wear = static_cast<double>(wear) * static_cast<double>(f.elastic_force) * path;
    add_to_walls(view.wall_sums, wall.facet, add);
  }

  template <class Tally>
  TANDEM_HD WallForce<Real> force_of(const SphereNearBody& m, const WallContact& wall, Tally& tally) const {
    const Parameters<Real>& p = view.parameters;
    const BodyPose& body = m.body;
    const Vec3d n = body.R * wall.normal, arm_body = body.R * wall.point;
    const Real radius = p.radius(m.position);
    Contact<Real> contact;
    contact.n = n.template as<Real>();
    contact.overlap = static_cast<Real>(-wall.gap - m.range());
    const Real arm = radius - contact.overlap;
    // All velocities are those of half a step ago, including that of the wall at the present contact point.
    // Otherwise a sphere held by a wall that rotates or accelerates would creep.
    const Vec3d arm_before = arm_body - 0.5 * now.dt * cross(body.w, arm_body);
    Vec3<Real> u = (m.v() - body.v - cross(body.w, arm_before)).template as<Real>();
    History<Real>* history = nullptr;
    if constexpr (Law::tangential) {
      u -= cross(arm * m.spin.w, contact.n);
      if (has_belts()) u -= belt_velocity(m, n).template as<Real>();
      history = wall_history<Law::extended>(view.surface.facets, m.list, m.near.first, wall, now.stamp);
    }
    contact.normal_speed = dot(u, contact.n);
    contact.slip = u - contact.normal_speed * contact.n;
    contact.dt = static_cast<Real>(now.dt);
    const Vec3<Real> body_spin = body.w.template as<Real>();
    if constexpr (Law::tangential)
      contact.normal_rotation = contact.dt / 2 * dot(m.spin.w + body_spin, contact.n);

    const WallFit<Real> fit = wall_fit(view, wall, m.kind(), radius);
    const Coefficients<Real>& k = fit.k;
    [[maybe_unused]] Extension<Real> extension;
    [[maybe_unused]] bool existed = false;
    [[maybe_unused]] Vec3<Real> spring_before;
    if constexpr (Law::extended) {
      extension = extend_at_wall(view, contact, p.material(m.kind()), radius,
                                 view.surface.patches[wall.patch].material, fit.r_eff);
      existed = history->stamp == now.stamp - 1;
      if (!Law::in_contact(contact, k, p.law, existed)) return {};
      if (existed) spring_before = history->spring;
    }
    const ContactForce<Real> f = contact_force<Law>(contact, k, p.law, history, now.stamp);
    const Vec3d exact = (f.normal * contact.n + f.tangential).template as<double>();
    if (!(norm2(exact) < p.force_limit * p.force_limit)) tally.raise(force_range, m.id());
    WallForce<Real> on_sphere;
    // Rounded once, so that the sphere loses exactly the momentum that is added to the body's load.
    on_sphere.force = rounded(exact, p.force);
    if constexpr (Law::tangential) {
      on_sphere.torque = arm * cross(f.tangential, contact.n);
      if (has_belts()) add_pull(m, f.tangential.template as<double>());
    }
    Vec3d moment = cross(arm_body, -on_sphere.force);
    if constexpr (Law::extended) {
      if (view.wall_sums.any())
        add_to_sums(wall, contact, f, on_sphere.force, spring_before, history->spring, extension.pair.wear);
      const Vec3<Real> rate = m.spin.w - body_spin;
      RollingSpring<Real>* rolling =
          m.list.rolling == nullptr ? nullptr : m.list.rolling + (history - m.list.history);
      const Vec3<Real> rolling_torque =
          rolling_moment(view, contact, f, extension, k.friction, rate, rolling, existed);
      on_sphere.torque += rolling_torque;
      moment -= rolling_torque.template as<double>();
      if (view.dissipation.any())
        add_dissipation(view.dissipation, m.near.sphere, 2, contact, f, spring_before, history->spring,
                        rolling_torque, rate);
    }
    tally.add_load(m.near.body, -on_sphere.force, moment, p.force, p.torque);
    tally.observe_overlap(static_cast<float>(contact.overlap * k.curvature));
    return on_sphere;
  }
};

}  // namespace tandem::dem
