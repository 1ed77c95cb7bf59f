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
#include "sph_server/step/arrays.hpp"
#include "sph_server/step/body_sum.hpp"
#include "sph_server/step/pair_sums.hpp"
#include "sph_server/step/tally.hpp"
#include "sph_server/step/team.hpp"

namespace tandem::sph {

// Added to the sums over neighbours, and to the tally.
struct WallSums {
  std::int64_t acceleration[3]{};  // by pressure, viscosity and repulsion, in quanta
  std::int64_t continuity = 0;     // in quanta
  Vec3d viscous, repelled;         // the parts of the acceleration by viscosity and by repulsion [m/s2]
  Vec3d surface;                   // sum of S n: gradient of the concentration of ghosts [1/m]
  double shadow = 0;               // sum of B [-]
};

// Of the particles that have facets in their lists.
template <class Real, bool shifting>
struct SumWalls {
  static constexpr bool by_teams = true;
  LiquidArrays<Real> liquid;
  const PairSums<Real, shifting>* pairs = nullptr;  // (count)
  const std::uint32_t* beside_wall = nullptr;       // the particles
  const std::uint32_t* before = nullptr;            // how many of them precede each particle
  WallSums* result = nullptr;                       // of each of them, in the order of particles
  WallArrays arrays;
  particles::CentreUnit<Real> centres;
  WallsView walls;
  WallConstants wall;
  WallRepulsion repulsion;
  WallKernel kernel;
  Quanta quanta;
  double mass = 0;        // of a particle [kg]
  double peak = 0;        // W(0) [1/m3]
  bool continued = true;  // false: the ghosts have the pressure of the particle, without its gradient

  // bodies: sums of the thread.
  template <class Team, class Bodies>
  TANDEM_HD void operator()(std::uint32_t number, const Team& team, Tally& tally, Bodies& bodies) const {
    const std::uint32_t i = beside_wall[number];
    const WallSums sum = arrays.near_count[i] > 0 ? of(i, team, tally, bodies) : WallSums{};
    if (team.leads()) result[before[i]] = sum;
  }

 private:
  struct Particle {
    Vec3d x, v, view;  // see WallArrays::viewpoint
    double pressure, volume;
  };

  // For the leader of the team.
  template <class Team, class Bodies>
  TANDEM_HD WallSums of(std::uint32_t i, const Team& team, Tally& tally, Bodies& bodies) const {
    const particles::FinePart<Real> fine = liquid.fine_part(i);
    const Particle p{centres.metres(centres.joined(liquid.position[i], fine)),
                     particles::velocity_of(liquid.velocity[i], fine), arrays.viewpoint[i],
                     static_cast<double>(liquid.state[i].pressure),
                     static_cast<double>(liquid.state[i].volume)};
    const std::uint32_t begin = arrays.facets.start[i];
    const SeenFacet* const seen = arrays.seen + begin;
    const FacetsOfParticle near{arrays.near + begin, static_cast<int>(arrays.near_count[i])};

    const FacetSums facets =
        team.sum([&](std::uint32_t lane) { return sum_of_lane(lane, p, near, seen, tally); });
    const Rim rim = rim_of(facets.rim, near, seen);
    const Vec3d by_neighbours =
        metric(pairs[i].acceleration, quanta) - pairs[i].viscous.template as<double>();
    const Vec3d pressed = by_neighbours + rim_pressure(wall, rim.sum, p.pressure, p.volume) + facets.pressed;
    // Parts of the kernel that neighbours and the particle itself fill.
    const double neighbours = static_cast<double>(pairs[i].filled), own = p.volume * peak;
    const double share =
        continued ? ghost_share(neighbours, filled_room(neighbours, own, facets.shadow), facets.missing) : 0;
    Mat3d represented = Mat3d::identity();
    for (int a = 0; a < 3; ++a) represented.row[a] += share * facets.missing.row[a];
    const Vec3d by_pressure = share * solved(represented, pressed);
    const Acceleration of_facets = team.sum(
        [&](std::uint32_t lane) { return load_of_lane(lane, p, near, seen, by_pressure, tally, bodies); });
    WallSums sum;
    if (!team.leads()) return sum;

    for (int a = 0; a < 3; ++a) sum.acceleration[a] = of_facets.of[a];
    sum.continuity = facets.continuity;
    sum.viscous = facets.viscous;
    sum.surface = facets.surface;
    sum.shadow = facets.shadow;
    tally.crowded_by_facets += facets.incomplete > 0 ? 1 : 0;
    arrays.by_pressure[i] = by_pressure;
    if (rim.along_r > 0) press_at_rims(p, near, seen, rim, sum, tally, bodies);
    if (facets.nearest.distance < repulsion.range) repel(p, near, facets.nearest, sum, tally, bodies);
    return sum;
  }

  TANDEM_HD static bool is_seen(const FacetIntegrals& integrals) {
    return integrals.surface != 0 || integrals.shadow != 0;
  }

  // The facet whose nearest point is nearest to the particle.
  struct Nearest {
    double distance = 1e300;  // [m]
    int facet = 0;

    TANDEM_HD void take(int k, const NearFacet& f, const Particle& p, double range) {
      particles::WallContact contact;
      if (touches(f, p, range, contact)) take({contact.gap + range, k});
    }
    // Of two at the same distance the first one.
    TANDEM_HD void take(const Nearest& b) {
      if (b.distance < distance || (b.distance == distance && b.facet < facet)) *this = b;
    }
    // The point of the contact is where it is now.
    TANDEM_HD static bool touches(const NearFacet& f, const Particle& p, double range,
                                  particles::WallContact& contact) {
      if (!particles::touch_triangle(particles::Facet{f.a, f.b, f.c, f.normal}, p.view, range, contact))
        return false;
      contact.point += p.x - p.view;
      return true;
    }
  };

  struct FacetSums {
    Vec3d pressed;                // acceleration by the pressure p_i of particle and ghosts [m/s2]
    Vec3d viscous, surface, rim;  // see WallSums and FacetIntegrals
    double shadow = 0;
    Mat3d missing;  // M of ghost_gradient()
    std::int64_t continuity = 0;
    Nearest nearest;
    std::uint64_t incomplete = 0;  // facets of which some parts are missing

    TANDEM_HD void add(const FacetSums& b) {
      pressed += b.pressed;
      viscous += b.viscous;
      surface += b.surface;
      rim += b.rim;
      shadow += b.shadow;
      for (int a = 0; a < 3; ++a) missing.row[a] += b.missing.row[a];
      continuity += b.continuity;
      nearest.take(b.nearest);
      incomplete += b.incomplete;
    }
  };
  TANDEM_HD FacetSums sum_of_lane(std::uint32_t lane, const Particle& p, const FacetsOfParticle& near,
                                  const SeenFacet* seen, Tally& tally) const {
    FacetSums sum;
    const double of_ghosts = p.volume * wall.density * wall.inverse_mass;
    for (int k = static_cast<int>(lane); k < near.count; k += static_cast<int>(wall_lanes)) {
      const NearFacet& f = near.facet[k];
      const FacetIntegrals& integrals = seen[k].integrals;
      sum.nearest.take(k, f, p, repulsion.range);
      sum.incomplete += seen[k].complete ? 0 : 1;
      sum.rim += integrals.rim;
      if (!is_seen(integrals)) continue;
      const AtFacet at(*this, p, f);
      const WallTerms t = at.terms(*this, p, f, integrals);
      sum.viscous += t.viscous;
      sum.continuity += particles::to_fixed(t.continuity, quanta.rate);
      sum.surface += integrals.surface * at.normal;
      sum.shadow += integrals.shadow;
      sum.pressed += t.pressure;
      tally.add(Power::viscosity, mass * dot(t.viscous, p.v - at.v_wall), quanta.power);
      for (int a = 0; a < 3; ++a) {
        sum.missing.row[a] += of_ghosts * (at.normal[a] * integrals.moment + integrals.sides.row[a]);
        sum.missing.row[a][a] -= of_ghosts * integrals.shadow;
      }
    }
    return sum;
  }

  struct Acceleration {
    std::int64_t of[3]{};  // in quanta
    TANDEM_HD void add(const Acceleration& b) {
      for (int a = 0; a < 3; ++a) of[a] += b.of[a];
    }
  };
  // Loads of a lane's facets. by_pressure: acceleration of the particle by pressure [m/s2].
  template <class Bodies>
  TANDEM_HD Acceleration load_of_lane(std::uint32_t lane, const Particle& p, const FacetsOfParticle& near,
                                      const SeenFacet* seen, Vec3d by_pressure, Tally& tally,
                                      Bodies& bodies) const {
    Acceleration sum;
    for (int k = static_cast<int>(lane); k < near.count;) {
      const std::uint32_t body = near.facet[k].body;
      const Vec3d arm = p.x - walls.pose[body].p;
      BodySum of_body;
      for (; k < near.count && near.facet[k].body == body; k += static_cast<int>(wall_lanes)) {
        const NearFacet& f = near.facet[k];
        const FacetIntegrals& integrals = seen[k].integrals;
        if (!is_seen(integrals)) continue;
        const AtFacet at(*this, p, f);
        const WallTerms t = at.terms(*this, p, f, integrals);
        const Vec3d ghost = ghost_gradient(wall, integrals, at.normal, by_pressure, p.volume);
        const Vec3d total = particles::rounded(t.pressure + t.viscous + ghost, quanta.acceleration);
        for (int a = 0; a < 3; ++a) sum.of[a] += particles::to_fixed(total[a], quanta.acceleration);
        of_body.add(-total, -mass * cross(arm, total), quanta);
        tally.add(Power::ghost, mass * dot(ghost, p.v - at.v_wall), quanta.power);
        tally.add(Power::walls, mass * dot(total, at.v_wall), quanta.power);
      }
      bodies.add(body, of_body);
    }
    return sum;
  }

  // Of the facets of one body, from k on.
  TANDEM_HD static Vec3d rim_of_body(const FacetsOfParticle& near, const SeenFacet* seen, int k) {
    Vec3d sum;
    for (const int end = near.end_of_body(k); k < end; ++k) sum += seen[k].integrals.rim;
    return sum;
  }
  // sum: of the rims of all facets.
  TANDEM_HD Rim rim_of(Vec3d sum, const FacetsOfParticle& near, const SeenFacet* seen) const {
    constexpr double rounding = 1e-10;  // of sides that cancel [-]
    if (norm(sum) * kernel.R <= rounding) return {};
    Rim rim;
    rim.sum = sum;
    for (int k = 0; k < near.count; k = near.end_of_body(k)) rim.add_body(rim_of_body(near, seen, k));
    return rim;
  }
  template <class Bodies>
  TANDEM_HD void press_at_rims(const Particle& p, const FacetsOfParticle& near, const SeenFacet* seen,
                               const Rim& rim, WallSums& sum, Tally& tally, Bodies& bodies) const {
    sum.surface += rim.sum;
    for (int k = 0; k < near.count; k = near.end_of_body(k)) {
      const Vec3d share = rim.share(rim_of_body(near, seen, k));
      const std::uint32_t body = near.facet[k].body;
      const Vec3d v_wall = velocity_of(body, p.x),
                  pressed = particles::rounded(rim_pressure(wall, share, p.pressure, p.volume),
                                               quanta.acceleration);
      sum.continuity += particles::to_fixed(rim_continuity(share, p.v - v_wall), quanta.rate);
      for (int a = 0; a < 3; ++a) sum.acceleration[a] += particles::to_fixed(pressed[a], quanta.acceleration);
      bodies.add(body, -pressed, -mass * cross(p.x - walls.pose[body].p, pressed), quanta);
      tally.add(Power::walls, mass * dot(pressed, v_wall), quanta.power);
    }
  }

  // Of the body where the particle is, so that a liquid that turns with it like a rigid body feels no shear.
  TANDEM_HD Vec3d velocity_of(std::uint32_t body, Vec3d x) const {
    const particles::BodyPose& pose = walls.pose[body];
    return pose.v + cross(pose.w, x - pose.p);
  }

  // Where a particle is beside a facet.
  struct AtFacet {
    double height;  // above the plane of the facet [m]
    Vec3d normal;   // towards the particle [-]
    Vec3d v_wall;   // [m/s]

    TANDEM_HD AtFacet(const SumWalls& sums, const Particle& p, const NearFacet& f)
        : height(f.height),
          normal(height < 0 ? -f.normal : f.normal),
          v_wall(sums.velocity_of(f.body, p.x)) {}
    TANDEM_HD WallTerms terms(const SumWalls& sums, const Particle& p, const NearFacet& f,
                              const FacetIntegrals& integrals) const {
      return wall_terms(sums.wall, integrals, normal, std::fabs(height), p.v - v_wall, p.pressure, p.volume,
                        sums.walls.slip[f.body] != 0);
    }
  };

  // Besides the nearest wall, the one that repels most on another side.
  template <class Bodies>
  TANDEM_HD void repel(const Particle& p, const FacetsOfParticle& near, const Nearest& nearest, WallSums& sum,
                       Tally& tally, Bodies& bodies) const {
    particles::WallContact first;
    Nearest::touches(near.facet[nearest.facet], p, repulsion.range, first);
    const std::uint32_t body_of_first = near.facet[nearest.facet].body;
    const double away = dot(p.v - velocity_of(body_of_first, first.point), first.normal);
    const double of_first = repulsion.of_nearest(nearest.distance, away);
    if (of_first > 0) push(p, body_of_first, first, of_first * first.normal, sum, tally, bodies);
    double strongest = 0;
    particles::WallContact second;
    std::uint32_t body = 0;
    Vec3d of_second;
    for (int k = 0; k < near.count; ++k) {
      const NearFacet& f = near.facet[k];
      particles::WallContact contact;
      if (k == nearest.facet || !Nearest::touches(f, p, repulsion.range, contact)) continue;
      const double distance = contact.gap + repulsion.range,
                   share = WallRepulsion::share(first.normal, contact.normal, f.normal),
                   strength = share * repulsion.acceleration(distance);
      if (!(strength > strongest)) continue;
      strongest = strength;
      second = contact;
      body = f.body;
      const Vec3d v_wall = velocity_of(body, contact.point);
      of_second = (strength - repulsion.damping(distance, share) * dot(p.v - v_wall, contact.normal)) *
                  contact.normal;
    }
    if (strongest > 0) push(p, body, second, of_second, sum, tally, bodies);
  }
  template <class Bodies>
  TANDEM_HD void push(const Particle& p, std::uint32_t body, const particles::WallContact& contact,
                      Vec3d acceleration, WallSums& sum, Tally& tally, Bodies& bodies) const {
    const Vec3d push = particles::rounded(acceleration, quanta.acceleration);
    const Vec3d arm = contact.point - walls.pose[body].p, v_wall = velocity_of(body, contact.point);
    for (int a = 0; a < 3; ++a) sum.acceleration[a] += particles::to_fixed(push[a], quanta.acceleration);
    sum.repelled += push;
    bodies.add(body, -push, -mass * cross(arm, push), quanta);
    tally.add(Power::repulsion, mass * dot(push, p.v - v_wall), quanta.power);
    tally.add(Power::walls, mass * dot(push, v_wall), quanta.power);
  }
};

}  // namespace tandem::sph
