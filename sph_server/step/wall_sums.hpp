// What walls do to one particle, and the particle to them.
#pragma once

#include <cmath>
#include <cstdint>

#include "particles/base/fixed_point.hpp"
#include "particles/geometry/touch_facet.hpp"
#include "particles/state/centre.hpp"
#include "sph_server/equations/spray.hpp"
#include "sph_server/equations/wall_repulsion.hpp"
#include "sph_server/equations/wall_terms.hpp"
#include "sph_server/kernel/common_edge.hpp"
#include "sph_server/kernel/seen_integrals.hpp"
#include "sph_server/neighbours/walls_view.hpp"
#include "sph_server/step/arrays.hpp"
#include "sph_server/step/pair_sums.hpp"
#include "sph_server/step/tally.hpp"

namespace tandem::sph {

// Facets of two bodies meet where the gap between them is below this [spacings].
inline constexpr double edge_gap = 0.25;

// The part of the kernel's surface integral over a plane below which a facet is a sliver [-].
inline constexpr double sliver = 1e-5;

// Sums of one body's walls, in quanta: of mass times acceleration, and of torque about the body's origin.
struct BodySum {
  std::int64_t acceleration[3]{};
  std::int64_t torque[3]{};

  void add(Vec3d by_mass, Vec3d moment, const Quanta& q) {
    for (int a = 0; a < 3; ++a) {
      acceleration[a] += particles::to_fixed(by_mass[a], q.acceleration);
      torque[a] += particles::to_fixed(moment[a], q.torque);
    }
  }
  void add(const BodySum& b) {
    for (int a = 0; a < 3; ++a) {
      acceleration[a] += b.acceleration[a];
      torque[a] += b.torque[a];
    }
  }
};

// Added to the sums over neighbours, and to the tally.
struct WallSums {
  std::int64_t acceleration[3]{};  // by pressure, viscosity and repulsion, in quanta
  std::int64_t continuity = 0;     // in quanta
  Vec3d viscous, repelled;         // the parts of the acceleration by viscosity and by repulsion [m/s2]
  Vec3d surface;                   // sum of S n: gradient of the concentration of ghosts [1/m]
  double shadow = 0;               // sum of B [-]
};

template <class Real>
struct SumWalls {
  LiquidArrays<Real> liquid;
  particles::CentreUnit<Real> centres;
  WallsView walls;
  WallConstants wall;
  WallRepulsion repulsion;
  WallKernel kernel;
  Quanta quanta;
  double mass = 0;        // of a particle [kg]
  double spacing = 0;     // [m]
  bool continued = true;  // false: the ghosts have the pressure of the particle, without its gradient

  struct Particle {
    Vec3d x, v;
    double pressure, volume;
  };
  // A facet as the particle sees it.
  struct SeenFacet {
    FacetIntegrals integrals;
    Vec3d normal, v_wall;  // towards the particle [-], at the nearest point of the plane [m/s]
    Vec3d foot;            // nearest point of the plane [m]
    Vec3d viscous;         // [m/s2]
    Vec3d force;           // divided by the mass of the particle, without the gradient of ghosts [m/s2]
    bool seen;
  };

  // pressed: acceleration of the particle by the pressure of its neighbours [m/s2]; neighbours, own: parts
  // of the kernel that they and the particle fill [-]. bodies: sums of the thread.
  template <class Bodies>
  TANDEM_HD WallSums operator()(std::uint32_t i, Vec3d pressed, double neighbours, double own, Tally& tally,
                                Bodies& bodies) const {
    WallSums sum;
    const particles::FinePart<Real> fine = liquid.fine_part(i);
    const Particle p{centres.metres(centres.joined(liquid.position[i], fine)),
                     particles::velocity_of(liquid.velocity[i], fine),
                     static_cast<double>(liquid.state[i].pressure),
                     static_cast<double>(liquid.state[i].volume)};
    NearWalls near;
    walls.find(p.x, kernel.R, near);
    if (near.count == 0) return sum;
    particles::UninitialisedArray<SeenFacet, NearWalls::most> facet;
    bool overflow = near.overflow, of_one_body = true;
    Mat3d missing;  // M of ghost_gradient
    const double of_ghosts = p.volume * wall.density * wall.inverse_mass;
    Nearest nearest;
    for (int k = 0; k < near.count; ++k) {
      SeenFacet& s = facet[k];
      const NearFacet& f = near.facet[k];
      nearest.take(f, p.x, repulsion.range);
      s.integrals = seen_integrals(p.x, near, k, kernel, overflow);
      s.seen = s.integrals.surface != 0 || s.integrals.shadow != 0;
      of_one_body = of_one_body && f.body == near.facet[0].body;
      if (!s.seen) continue;
      const double height = dot(p.x - f.a, f.normal);
      s.normal = height < 0 ? -f.normal : f.normal;
      const particles::BodyPose& pose = walls.pose[f.body];
      s.foot = p.x - height * f.normal;
      s.v_wall = pose.v + cross(pose.w, s.foot - pose.p);
      const WallTerms t = wall_terms(wall, s.integrals, s.normal, std::fabs(height), p.v - s.v_wall,
                                     p.pressure, p.volume, walls.slip[f.body] != 0);
      s.viscous = t.viscous;
      s.force = t.pressure + t.viscous;
      sum.viscous += t.viscous;
      sum.continuity += particles::to_fixed(t.continuity, quanta.rate);
      sum.surface += s.integrals.surface * s.normal;
      sum.shadow += s.integrals.shadow;
      pressed += t.pressure;
      tally.add(Power::viscosity, mass * dot(t.viscous, p.v - s.v_wall), quanta.power);
      for (int a = 0; a < 3; ++a) {
        missing.row[a] += of_ghosts * (s.normal[a] * s.integrals.moment + s.integrals.sides.row[a]);
        missing.row[a][a] -= of_ghosts * s.integrals.shadow;
      }
    }
    tally.crowded_by_facets += overflow ? 1 : 0;
    const double share =
        continued ? ghost_share(neighbours, filled_room(neighbours, own, sum.shadow), missing) : 0;
    Mat3d represented = Mat3d::identity();
    for (int a = 0; a < 3; ++a) represented.row[a] += share * missing.row[a];
    const Vec3d by_pressure = share * solved(represented, pressed);
    for (int k = 0; k < near.count; ++k) {
      const SeenFacet& s = facet[k];
      if (!s.seen) continue;
      const Vec3d ghost = ghost_gradient(wall, s.integrals, s.normal, by_pressure, p.volume);
      const Vec3d total = particles::rounded(s.force + ghost, quanta.acceleration);
      const std::uint32_t body = near.facet[k].body;
      const particles::BodyPose& pose = walls.pose[body];
      // Pressure acts on the wall along the line to the particle, shear at the nearest point of its plane.
      const Vec3d shear =
          s.viscous +
          (walls.slip[body] != 0 ? Vec3d{} : shear_of_turning(wall, s.integrals, s.normal, pose.w, p.volume));
      const Vec3d moment = cross(p.x - pose.p, total - s.viscous) + cross(s.foot - pose.p, shear);
      for (int a = 0; a < 3; ++a) sum.acceleration[a] += particles::to_fixed(total[a], quanta.acceleration);
      bodies.add(body, -total, -mass * moment, quanta);
      tally.add(Power::ghost, mass * dot(ghost, p.v - s.v_wall), quanta.power);
      tally.add(Power::walls, mass * dot(total, s.v_wall), quanta.power);
    }
    if (nearest.distance < repulsion.range) repel(p, nearest, sum, tally, bodies);
    if (!of_one_body) add_common_edges(p, near, facet.data(), by_pressure, tally, bodies);
    return sum;
  }

 private:
  // The nearest point of all facets within a range.
  struct Nearest {
    double distance = 1e300;  // [m]
    Vec3d point, normal;      // towards the particle [m], [-]
    std::uint32_t body = 0;

    TANDEM_HD void take(const NearFacet& f, Vec3d x, double range) {
      particles::WallContact contact;
      const particles::Facet facet{f.a, f.b, f.c, f.normal};
      if (!particles::touch_triangle(facet, x, range, contact) || contact.gap + range >= distance) return;
      distance = contact.gap + range;
      point = contact.point;
      normal = contact.normal;
      body = f.body;
    }
  };

  template <class Bodies>
  TANDEM_HD void repel(const Particle& p, const Nearest& nearest, WallSums& sum, Tally& tally,
                       Bodies& bodies) const {
    const Vec3d push =
        particles::rounded(repulsion.acceleration(nearest.distance) * nearest.normal, quanta.acceleration);
    const particles::BodyPose& pose = walls.pose[nearest.body];
    const Vec3d v_wall = pose.v + cross(pose.w, nearest.point - pose.p);
    for (int a = 0; a < 3; ++a) sum.acceleration[a] += particles::to_fixed(push[a], quanta.acceleration);
    sum.repelled = push;
    bodies.add(nearest.body, -push, -mass * cross(nearest.point - pose.p, push), quanta);
    tally.add(Power::repulsion, mass * dot(push, p.v - v_wall), quanta.power);
    tally.add(Power::walls, mass * dot(push, v_wall), quanta.power);
  }

  // Loads that the ghost liquid behind walls of two bodies passes from one to the other at their common
  // edges. The liquid does not notice them.
  template <class Bodies>
  TANDEM_HD void add_common_edges(const Particle& p, const NearWalls& near, const SeenFacet* facet,
                                  Vec3d by_pressure, Tally& tally, Bodies& bodies) const {
    // Rounding leaves slivers of hidden facets in sight, such as of the back of a plate.
    const auto in_sight = [&](int k) {
      return facet[k].seen && std::fabs(facet[k].integrals.surface) * kernel.R > sliver;
    };
    for (int k = 0; k < near.count; ++k)
      for (int other = 0; other < near.count; ++other) {
        const NearFacet &f = near.facet[k], &g = near.facet[other];
        if (f.body == g.body || !in_sight(k) || !in_sight(other)) continue;
        Vec3d strip[4];
        if (!strip_beyond({{f.a, f.b, f.c}, f.normal}, {{g.a, g.b, g.c}, g.normal}, p.x, 2 * kernel.R,
                          edge_gap * spacing, strip))
          continue;
        const FacetIntegrals integrals = facet_integrals(p.x, strip, 4, f.normal, kernel);
        const double push =
            p.volume * wall.inverse_mass *
            (2 * p.pressure * integrals.surface - wall.density * dot(by_pressure, integrals.moment));
        const Vec3d force = particles::rounded(-push * facet[k].normal, quanta.acceleration);
        const particles::BodyPose &pose_f = walls.pose[f.body], &pose_g = walls.pose[g.body];
        const Vec3d arm_f = p.x - pose_f.p, arm_g = p.x - pose_g.p;
        bodies.add(f.body, force, mass * cross(arm_f, force), quanta);
        bodies.add(g.body, -force, -mass * cross(arm_g, force), quanta);
        const Vec3d apart = pose_f.v + cross(pose_f.w, arm_f) - pose_g.v - cross(pose_g.w, arm_g);
        tally.add(Power::edges, mass * dot(force, apart), quanta.power);
      }
  }
};

}  // namespace tandem::sph
