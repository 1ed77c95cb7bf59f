// Stiffness and damping of all contacts of spheres with walls at the end of a window, with the spheres held
// in place. A law offers its force only (dem_server/laws); the derivatives are central differences of the
// force, in double precision in every run. A contact that slides has no stiffness along its slip. The
// increase of the friction limit with the overlap is neglected, which keeps the stiffness symmetric.
//
// Whether a contact slides follows from the velocity of the wall at the window's end and that of the sphere
// half a micro step before. A micro step takes both half a step before; the spring's length differs by dt^2/2
// times the acceleration.
//
// A list that is due for a rebuild is used as it is: contacts that it may miss have approached by less than
// the motion of one micro step.
#pragma once

#include "dem_server/contact/wall_forces.hpp"
#include "dem_server/engine/contact_tangent.hpp"

namespace tandem::dem {

// The derivatives of the law at a contact with the spring of its last micro step.
template <class Law>
TANDEM_HD void differentiate(const Contact<double>& at, const Coefficients<double>& k, std::uint32_t law,
                             Vec3d spring, ContactTangent& out) {
  const auto normal = [&](double overlap, double speed) {
    Contact<double> c = at;
    c.overlap = overlap;
    c.normal_speed = speed;
    Vec3d s = spring;
    return Law{}(c, k, law, s).normal;
  };
  double depth = 1e-4 * std::abs(at.overlap);  // [m]
  // Adhesion can hold a gap, so that the overlap alone does not tell how small a motion has to be. The motion
  // must not open a contact that has an overlap.
  if (at.adhesion > 0) depth += 1e-9 * at.r_eff;
  if (at.overlap > 0 && depth > at.overlap / 2) depth = at.overlap / 2;
  const double speed = 1;  // [m/s]; any value would do, since the force is linear in the speed
  out.k_n = (normal(at.overlap + depth, 0) - normal(at.overlap - depth, 0)) / (2 * depth);
  out.d_n = (normal(at.overlap, -speed) - normal(at.overlap, speed)) / (2 * speed);
  if constexpr (Law::tangential) {
    // Evaluates the law with the spring at the start of the next micro step, so that the contact slides here
    // if it slides in that step.
    const Vec3d next = spring + at.dt * at.slip;
    const Vec3d across = norm2(next) > 0 ? next : cross(at.n, Vec3d{at.n.y, at.n.z, -at.n.x});
    if (!(norm2(across) > 0)) return;
    const Vec3d along = normalized(across - dot(across, at.n) * at.n);
    const auto tangential = [&](double shift, double faster) {
      Contact<double> c = at;
      c.dt = 0;
      c.slip += faster * along;
      Vec3d s = next + shift * along;
      return dot(Law{}(c, k, law, s).tangential, along);
    };
    const double shift = 1e-2 * depth, faster = shift / at.dt;
    const double k_t = (tangential(-shift, 0) - tangential(shift, 0)) / (2 * shift);
    const double d_t = (tangential(0, -faster) - tangential(0, faster)) / (2 * faster);
    out.k_t = k_t > 0 ? k_t : 0;
    out.d_t = d_t > 0 ? d_t : 0;
  }
}

// A contact with a wall, ready for the law.
struct WallContactState {
  Vec3d arm;  // from the origin of the wall's body to the contact, world axes [m]
  Contact<double> contact;
  Coefficients<double> k;
  Vec3d spring;  // of the last micro step [m]
};

// The contacts of one sphere with the walls of one body near it, in a fixed order.
template <class Law, class Real>
struct WallTangents {
  const View<Real>& view;
  const BodyPose* pose;                                     // of each body
  CurrentStep now{*view.window, view.window->progress[0]};  // at the window's end

  // The tangent of pair `which` of a sphere and a body near it.
  TANDEM_HD WallTangent of(std::uint32_t which) const {
    WallTangent sum;
    if (view.lists.near[which].body == ground_index) return sum;
    each_contact(which, [&](const WallContactState& at) { add(tangent(at), sum); });
    return sum;
  }

  // Calls visit(contact) for each contact of pair `which`.
  template <class Visit>
  TANDEM_HD void each_contact(std::uint32_t which, const Visit& visit) const {
    const NearBody& near = view.lists.near[which];
    const PositionRadius<Real>& position = view.spheres.position[now.state_side][near.sphere];
    if (is_parked(position)) return;
    const BodyPose& body = pose[near.body];
    const Vec3d centre = body.R.transpose_times(view.centre(now.state_side, near.sphere) - body.p);
    WallContactSpace space;
    const int contacts = collect_wall_contacts(
        centre, view.parameters.unit.exact_metres(position.radius) + range(),
        view.lists.walls.entry + near.first, static_cast<int>(near.count), view.surface.facets, space);
    // A sphere with too many contacts has already ended the run.
    for (int w = 0; w < contacts; ++w) {
      WallContactState at;
      if (prepare(near, space.contacts[w], at)) visit(at);
    }
  }

 private:
  TANDEM_HD ContactTangent tangent(const WallContactState& at) const {
    ContactTangent result;
    result.normal = at.contact.n;
    result.arm = at.arm;
    differentiate<Law>(at.contact, at.k, view.parameters.law, at.spring, result);
    return result;
  }
  // Returns false where the law has no contact there.
  TANDEM_HD bool prepare(const NearBody& near, const WallContact& wall, WallContactState& at) const {
    const Parameters<Real>& p = view.parameters;
    const PositionRadius<Real>& position = view.spheres.position[now.state_side][near.sphere];
    const BodyPose& body = pose[near.body];
    at.arm = body.R * wall.point;
    Contact<double>& contact = at.contact;
    contact.n = body.R * wall.normal;
    contact.overlap = -wall.gap - range();
    contact.dt = now.dt;
    Vec3d u = view.velocity(now.state_side, near.sphere) - body.v - cross(body.w, at.arm);
    if constexpr (Law::tangential) {
      const double arm = p.unit.exact_metres(position.radius) - contact.overlap;
      u -= cross(arm * view.spheres.spin[now.state_side][near.sphere].w.template as<double>(), contact.n);
    }
    contact.normal_speed = dot(u, contact.n);
    contact.slip = u - contact.normal_speed * contact.n;
    const std::uint32_t kind = view.spheres.velocity[now.state_side][near.sphere].kind();
    const WallFit<Real> fit = wall_fit(view, wall, kind, p.radius(position));
    const Coefficients<Real>& k = fit.k;
    at.k = {static_cast<double>(k.k_n), static_cast<double>(k.c_n), static_cast<double>(k.k_t),
            static_cast<double>(k.c_t), static_cast<double>(k.friction)};
    const History<Real>* history = known(near, wall);
    if constexpr (Law::extended) {
      // The moments of rolling and twisting are neglected: they rotate the sphere, but hardly the body.
      Contact<Real> sizes;
      extend_at_wall(view, sizes, p.material(kind), p.radius(position),
                     view.surface.patches[wall.patch].material, fit.r_eff);
      contact.r_eff = static_cast<double>(sizes.r_eff);
      contact.m_eff = static_cast<double>(sizes.m_eff);
      contact.adhesion = static_cast<double>(sizes.adhesion);
      if (!Law::in_contact(contact, at.k, p.law, history != nullptr)) return false;
    }
    if (history != nullptr) at.spring = history->spring.template as<double>();
    return true;
  }
  TANDEM_HD double range() const {
    if constexpr (Law::extended)
      return view.parameters.unit.exact_metres(view.parameters.range);
    else
      return 0;
  }
  // History of a contact that existed in the last step, else null. It searches as wall_history() does, but
  // moves nothing.
  TANDEM_HD const History<Real>* known(const NearBody& near, const WallContact& wall) const {
    if constexpr (Law::tangential) {
      const WallList<Real>& list = view.lists.walls;
      for (const std::uint32_t patch : {wall.patch, wall.neighbour})
        for (std::uint32_t k = near.first; k < near.first + near.count; ++k) {
          if (view.surface.facets[list.entry[k]].patch != patch) continue;
          if (list.history[k].stamp == now.stamp - 1) return list.history + k;
          break;
        }
    }
    return nullptr;
  }
};

// The pairs that can be evaluated: none after a rebuild that did not fit, whose lists do not belong to the
// present order of the spheres.
TANDEM_HD inline std::uint32_t listed_pairs(const WindowProgress& c) {
  return c.error != 0 ? 0 : c.near;
}

// Finds the tangent of each pair of a sphere and a body near it.
template <class Law, class Real>
struct FindWallTangents {
  View<Real> view;
  const BodyPose* pose;  // of each body
  WallTangent* tangent;  // (near)

  TANDEM_HD void operator()(std::uint32_t which) const {
    if (which < listed_pairs(*view.window)) tangent[which] = WallTangents<Law, Real>{view, pose}.of(which);
  }
};

// The sum over the pairs of one body has the same order for any number of threads: first the pairs of each
// run, from the first to the last, and then the runs.
inline constexpr std::uint32_t tangent_runs = 128;

// Sums over the pairs of one run; one iteration for each run and entry of a tangent.
struct SumTangentRuns {
  const WindowProgress* window;
  const NearBody* near;
  std::uint32_t bodies;
  const WallTangent* tangent;  // (near)
  WallTangent* sum;            // (tangent_runs x bodies), zero

  static constexpr std::uint32_t at_once = 8;  // concurrent loads

  TANDEM_HD void operator()(std::uint32_t i) const {
    const std::uint32_t run = i / WallTangent::entries, k = i % WallTangent::entries;
    const std::uint32_t count = listed_pairs(*window);
    const auto begin_of = [count](std::uint32_t r) {
      return static_cast<std::uint32_t>(std::uint64_t{count} * r / tangent_runs);
    };
    const std::uint32_t begin = begin_of(run), end = begin_of(run + 1);
    if (begin == end) return;
    std::uint32_t body = 0;
    double of_body = 0;
    const auto keep = [&] { sum[std::size_t{run} * bodies + body].entry[k] += of_body; };
    for (std::uint32_t first = begin; first < end; first += at_once) {
      std::uint32_t body_of[at_once];
      double tangent_of[at_once];
      for (std::uint32_t n = 0; n < at_once; ++n) {
        const std::uint32_t which = first + n < end ? first + n : end - 1;
        body_of[n] = fetch(&near[which].body);
        tangent_of[n] = fetch(&tangent[which].entry[k]);
      }
      for (std::uint32_t n = 0; n < at_once && first + n < end; ++n) {
        if (body_of[n] != body) {
          keep();
          body = body_of[n];
          of_body = 0;
        }
        of_body += tangent_of[n];
      }
    }
    keep();
  }
};

// Sums over the runs; one iteration for each body and entry of a tangent.
struct SumTangents {
  std::uint32_t bodies;
  const WallTangent* of_run;  // (tangent_runs x bodies)
  WallTangent* sum;           // (bodies)

  TANDEM_HD void operator()(std::uint32_t i) const {
    const std::uint32_t body = i / WallTangent::entries, k = i % WallTangent::entries;
    double all = 0;
    for (std::uint32_t run = 0; run < tangent_runs; ++run)
      all += of_run[std::size_t{run} * bodies + body].entry[k];
    sum[body].entry[k] = all;
  }
};

}  // namespace tandem::dem
