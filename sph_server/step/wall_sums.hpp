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

    FacetSums all;
    for (int k = 0; k < near.count; k = near.end_of_body(k)) all.add(of_body(k, p, near, seen, team));
    const Rim rim = rim_of(all.rim, near, seen);
    const Vec3d by_neighbours =
        metric(pairs[i].acceleration, quanta) - pairs[i].viscous.template as<double>();
    const Vec3d surface = all.surface + rim.sum,
                pressed = by_neighbours + wall_pressure(wall, surface, p.pressure, p.volume);
    // Parts of the kernel that neighbours and the particle itself fill.
    const double neighbours = static_cast<double>(pairs[i].filled), own = p.volume * peak;
    const double of_ghosts = p.volume * wall.density * wall.inverse_mass;
    const Mat3d missing = product(of_ghosts, all.missing);
    const double share =
        continued ? ghost_share(neighbours, filled_room(neighbours, own, all.shadow), missing) : 0;
    const Vec3d by_pressure = share * solved(sum_of(Mat3d::identity(), product(share, missing)), pressed);

    WallSums sum;
    sum.surface = surface;
    sum.shadow = all.shadow;
    for (int k = 0; k < near.count;) {
      const int end = near.end_of_body(k);
      const bool only = k == 0 && end == near.count;
      const FacetSums facets = only ? all : of_body(k, p, near, seen, team);
      if (team.leads())
        load(p, near.facet[k].body, facets, facets.surface + rim.share(facets.rim),
             (-of_ghosts) * (facets.missing * by_pressure), sum, tally, bodies);
      k = end;
    }
    if (!team.leads()) return sum;
    tally.crowded_by_facets += all.incomplete > 0 ? 1 : 0;
    arrays.by_pressure[i] = by_pressure;
    if (all.nearest.distance < repulsion.range) repel(p, near, all.nearest, sum, tally, bodies);
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
      if (!(std::fabs(f.height) < range)) return false;  // before its corners are read
      if (!particles::touch_triangle(particles::Facet{f.a, f.b, f.c, f.normal}, p.view, range, contact))
        return false;
      contact.point += p.x - p.view;
      return true;
    }
  };

  struct FacetSums {
    Vec3d viscous;       // acceleration [m/s2]
    Vec3d surface, rim;  // see WallSums and FacetIntegrals
    double shadow = 0;
    Mat3d missing;  // see add_missing()
    Nearest nearest;
    std::uint64_t incomplete = 0;  // facets of which some parts are missing

    TANDEM_HD void add(const FacetSums& b) {
      viscous += b.viscous;
      surface += b.surface;
      rim += b.rim;
      shadow += b.shadow;
      missing = sum_of(missing, b.missing);
      nearest.take(b.nearest);
      incomplete += b.incomplete;
    }
  };
  // Of the facets of one body, from k on.
  template <class Team>
  TANDEM_HD FacetSums of_body(int k, const Particle& p, const FacetsOfParticle& near, const SeenFacet* seen,
                              const Team& team) const {
    const int end = near.end_of_body(k);
    return team.sum(
        [&](std::uint32_t lane) { return sum_of_lane(k + static_cast<int>(lane), end, p, near, seen); });
  }
  TANDEM_HD FacetSums sum_of_lane(int k, int end, const Particle& p, const FacetsOfParticle& near,
                                  const SeenFacet* seen) const {
    FacetSums sum;
    if (k >= end) return sum;
    const std::uint32_t body = near.facet[k].body;
    const bool slip = walls.slip[body] != 0;
    const Vec3d v = p.v - velocity_of(body, p.x);
    for (; k < end; k += static_cast<int>(wall_lanes)) {
      const NearFacet& f = near.facet[k];
      const FacetIntegrals& integrals = seen[k].integrals;
      sum.nearest.take(k, f, p, repulsion.range);
      sum.incomplete += seen[k].complete ? 0 : 1;
      sum.rim += integrals.rim;
      if (!is_seen(integrals)) continue;
      const Vec3d normal = f.height < 0 ? -f.normal : f.normal;
      if (!slip)
        sum.viscous += p.volume * wall_friction(wall, integrals.surface, normal, std::fabs(f.height), v);
      sum.surface += integrals.surface * normal;
      sum.shadow += integrals.shadow;
      add_missing(integrals, normal, sum.missing);
    }
    return sum;
  }

  // What the facets of a body and the particle do to each other. ghost: acceleration by the difference of the
  // pressures of ghosts and particle [m/s2], see add_missing().
  template <class Bodies>
  TANDEM_HD void load(const Particle& p, std::uint32_t body, const FacetSums& facets, Vec3d surface,
                      Vec3d ghost, WallSums& sum, Tally& tally, Bodies& bodies) const {
    const Vec3d v_wall = velocity_of(body, p.x), v = p.v - v_wall;
    const Vec3d pressure = wall_pressure(wall, surface, p.pressure, p.volume);
    const Vec3d total = particles::rounded(pressure + facets.viscous + ghost, quanta.acceleration);
    for (int a = 0; a < 3; ++a) sum.acceleration[a] += particles::to_fixed(total[a], quanta.acceleration);
    sum.continuity += particles::to_fixed(wall_continuity(surface, v), quanta.rate);
    sum.viscous += facets.viscous;
    bodies.add(body, -total, -mass * cross(p.x - walls.pose[body].p, total), quanta);
    tally.add(Power::viscosity, mass * dot(facets.viscous, v), quanta.power);
    tally.add(Power::ghost, mass * dot(ghost, v), quanta.power);
    tally.add(Power::walls, mass * dot(total, v_wall), quanta.power);
  }

  // sum: of the rims of all facets.
  TANDEM_HD Rim rim_of(Vec3d sum, const FacetsOfParticle& near, const SeenFacet* seen) const {
    constexpr double rounding = 1e-10;  // of sides that cancel [-]
    if (norm(sum) * kernel.R <= rounding) return {};
    Rim rim;
    rim.sum = sum;
    for (int k = 0; k < near.count;) {
      Vec3d of_body;
      for (const int end = near.end_of_body(k); k < end; ++k) of_body += seen[k].integrals.rim;
      rim.add_body(of_body);
    }
    return rim;
  }

  // Of the body where the particle is, so that a liquid that turns with it like a rigid body feels no shear.
  TANDEM_HD Vec3d velocity_of(std::uint32_t body, Vec3d x) const {
    const particles::BodyPose& pose = walls.pose[body];
    return pose.v + cross(pose.w, x - pose.p);
  }

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
