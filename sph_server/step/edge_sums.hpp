// Loads that the ghost liquid behind walls of two bodies passes from one to the other at their common edges
// (kernel/common_edge.hpp). The liquid does not notice them.
#pragma once

#include <cmath>
#include <cstdint>

#include "particles/state/centre.hpp"
#include "sph_server/equations/wall_terms.hpp"
#include "sph_server/kernel/common_edge.hpp"
#include "sph_server/step/arrays.hpp"
#include "sph_server/step/body_sum.hpp"
#include "sph_server/step/tally.hpp"

namespace tandem::sph {

// Facets of two bodies meet where the gap between them is below this [spacings].
inline constexpr double edge_gap = 0.25;

// The part of the kernel's surface integral over a plane below which a facet is a sliver [-]. Rounding leaves
// slivers of hidden facets in sight, such as of the back of a plate.
inline constexpr double sliver = 1e-5;

// One facet near one particle, against those of other bodies near it. Of particles that have several bodies
// in their lists.
template <class Real>
struct SumEdges {
  static constexpr bool by_teams = false;
  LiquidArrays<Real> liquid;
  WallArrays arrays;
  const std::uint32_t* entries = nullptr;  // see MarkBetweenBodies
  particles::CentreUnit<Real> centres;
  WallsView walls;
  WallConstants wall;
  WallKernel kernel;
  Quanta quanta;
  double mass = 0;     // of a particle [kg]
  double spacing = 0;  // [m]

  // `bodies`: sums of this thread.
  template <class Bodies>
  TANDEM_HD void operator()(std::uint32_t number, Tally& tally, Bodies& bodies) const {
    const std::uint32_t entry = entries[number];
    const std::uint32_t i = arrays.particle[entry], begin = arrays.facets.start[i],
                        count = arrays.near_count[i];
    // Those of a body follow each other.
    if (entry - begin >= count || arrays.near[begin].body == arrays.near[begin + count - 1].body) return;
    if (!in_sight(entry)) return;
    const NearFacet& f = arrays.near[entry];
    for (std::uint32_t other = begin; other < begin + count; ++other)
      if (arrays.near[other].body != f.body && in_sight(other)) add(i, f, arrays.near[other], tally, bodies);
  }

 private:
  TANDEM_HD bool in_sight(std::uint32_t entry) const {
    return std::fabs(arrays.seen[entry].integrals.surface) * kernel.R > sliver;
  }

  // Acceleration of particle i by ghost liquid that ends at the strip.
  TANDEM_HD double push(std::uint32_t i, Vec3d x, const Vec3d* strip, Vec3d normal) const {
    const FacetIntegrals integrals = facet_integrals(x, strip, 4, normal, kernel);
    return static_cast<double>(liquid.state[i].volume) * wall.inverse_mass *
           (2 * static_cast<double>(liquid.state[i].pressure) * integrals.surface -
            wall.density * dot(arrays.by_pressure[i], integrals.moment));
  }

  template <class Bodies>
  TANDEM_HD void add(std::uint32_t i, const NearFacet& f, const NearFacet& g, Tally& tally,
                     Bodies& bodies) const {
    const Vec3d x = centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)));
    const Triangle of_f{{f.a, f.b, f.c}, f.normal}, of_g{{g.a, g.b, g.c}, g.normal};
    const Vec3d view = arrays.viewpoint[i];
    Vec3d strip[4], outward;
    Vec3d force;
    if (strip_beyond(of_f, of_g, view, 2 * kernel.R, edge_gap * spacing, strip))
      force = push(i, view, strip, f.normal) * (dot(view - f.a, f.normal) < 0 ? f.normal : -f.normal);
    else if (strip_between(of_f, of_g, view, 2 * kernel.R, edge_gap * spacing, strip, outward))
      // Half of it, since the particles on both sides press, and the half of that again for g and f.
      force = -0.25 * push(i, view, strip, outward) * outward;
    else
      return;
    force = particles::rounded(force, quanta.acceleration);
    const particles::BodyPose &pose_f = walls.pose[f.body], &pose_g = walls.pose[g.body];
    const Vec3d arm_f = x - pose_f.p, arm_g = x - pose_g.p;
    bodies.add(f.body, force, mass * cross(arm_f, force), quanta);
    bodies.add(g.body, -force, -mass * cross(arm_g, force), quanta);
    const Vec3d apart = pose_f.v + cross(pose_f.w, arm_f) - pose_g.v - cross(pose_g.w, arm_g);
    tally.add(Power::edges, mass * dot(force, apart), quanta.power);
  }
};

}  // namespace tandem::sph
