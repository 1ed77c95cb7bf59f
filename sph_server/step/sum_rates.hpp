// Rates of one particle from its neighbours and from walls: the only pass over the neighbours in a step.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "particles/base/fixed_point.hpp"
#include "particles/state/centre.hpp"
#include "sph_server/equations/pair_terms.hpp"
#include "sph_server/equations/state.hpp"
#include "sph_server/equations/wall_terms.hpp"
#include "sph_server/kernel/common_edge.hpp"
#include "sph_server/kernel/visible_part.hpp"
#include "sph_server/step/arrays.hpp"
#include "sph_server/step/tally.hpp"

namespace tandem::sph {

// Sums of one body's walls, in quanta: of mass times acceleration, and of torque about the body's origin.
struct BodySum {
  std::int64_t acceleration[3]{};
  std::int64_t torque[3]{};
};

struct Quanta {
  dem::Quantum acceleration;  // [m/s2]
  dem::Quantum rate;          // [1/s]
  dem::Quantum power;         // [W]
  dem::Quantum torque;        // [N m]
};

// Facets of two bodies meet where the gap between them is below this [spacings].
inline constexpr double edge_gap = 0.25;

// The integrals over what x sees of facet k.
TANDEM_HD inline FacetIntegrals seen_integrals(Vec3d x, const NearWalls& near, int k,
                                               const WallKernel& kernel, bool& overflow) {
  const NearFacet& f = near.facet[k];
  const Vec3d corner[3] = {f.a, f.b, f.c};
  const double tolerance = 1e-6 * kernel.R;
  Polygon whole;
  whole.count = 3;
  for (int n = 0; n < 3; ++n) whole.corner[n] = corner[n];
  const auto may_hide = [&](const NearFacet& g) {
    const double height = dot(x - g.a, g.normal);
    if (std::fabs(height) <= tolerance) return false;
    const Vec3d away = height > 0 ? -g.normal : g.normal;
    return reaches_beyond(whole, g.a, away, tolerance);
  };
  int other = 0;
  while (other < near.count && (other == k || !may_hide(near.facet[other]))) ++other;
  if (other == near.count) return facet_integrals(x, corner, 3, f.normal, kernel);
  Fragments parts;
  parts.add(whole);
  for (; other < near.count && parts.count > 0; ++other)
    if (const NearFacet& g = near.facet[other]; other != k && may_hide(g))
      remove_hidden(parts, x, g.a, g.b, g.c, g.normal, tolerance);
  overflow = overflow || parts.overflow;
  FacetIntegrals sum;
  for (int n = 0; n < parts.count; ++n)
    sum += facet_integrals(x, parts.part[n].corner.data(), parts.part[n].count, f.normal, kernel);
  return sum;
}

template <class Real>
struct SumRates {
  LiquidArrays<Real> liquid;
  dem::LengthUnit<Real> unit;
  dem::CentreUnit<Real> centres;
  Vec3<typename dem::LengthUnit<Real>::Count> period;
  PairConstants<Real> pair;
  WallConstants wall;
  WallKernel wall_kernel;
  Liquid properties;
  const Walls* walls = nullptr;
  Quanta quanta;

  TANDEM_HD Seen<Real> seen(std::uint32_t i) const {
    return {liquid.velocity[i].v, liquid.state[i].pressure, liquid.state[i].volume};
  }

  // `bodies`: sums of this thread, one per body.
  void operator()(std::uint32_t i, Tally& tally, BodySum* bodies) const {
    std::int64_t sum[3]{}, continuity = 0, diffusion = 0;
    double viscous_power = 0;
    const Seen<Real> self = seen(i);
    const dem::PositionRadius<Real> here = liquid.position[i];
    for (std::uint32_t n = liquid.start[i]; n < liquid.start[i + 1]; ++n) {
      const Neighbour neighbour = liquid.neighbour[n];
      const std::uint32_t j = neighbour.index();
      const Vec3<Real> d = apart(here, liquid.position[j], neighbour.image());
      const Real r2 = norm2(d);
      if (r2 >= pair.support2) continue;
      const Seen<Real> other = seen(j);
      const PairTerms<Real> t = pair_terms(pair, d, r2, self, other);
      const Vec3<Real> force = t.pressure + t.viscous;
      for (int a = 0; a < 3; ++a) sum[a] += dem::to_fixed(static_cast<double>(force[a]), quanta.acceleration);
      continuity += dem::to_fixed(static_cast<double>(t.continuity), quanta.rate);
      diffusion += dem::to_fixed(static_cast<double>(t.diffusion), quanta.rate);
      viscous_power += static_cast<double>(dot(t.viscous, self.v - other.v));
    }
    for (int a = 0; a < 3; ++a) tally.momentum_rate[a] += sum[a];
    const double mass = properties.mass();
    tally.add(Power::viscosity, 0.5 * mass * viscous_power, quanta.power);

    const Vec3d v = dem::velocity_of(liquid.velocity[i], liquid.fine_part(i));
    if (walls->any()) add_walls(i, v, sum, continuity, tally, bodies);

    const double compression = liquid.compression[i], volume = static_cast<double>(self.volume);
    const double by_motion = dem::from_fixed(continuity, quanta.rate),
                 by_diffusion = dem::from_fixed(diffusion, quanta.rate);
    const double elastic =
        properties.density * properties.sound_speed * properties.sound_speed * tait_pressure(compression);
    tally.add(Power::bulk_viscosity, -(static_cast<double>(self.pressure) - elastic) * volume * by_motion,
              quanta.power);
    tally.add(Power::diffusion, elastic * volume / (1 + compression) * by_diffusion, quanta.power);

    Vec3d acceleration = properties.gravity;
    for (int a = 0; a < 3; ++a) acceleration[a] += dem::from_fixed(sum[a], quanta.acceleration);
    tally.add(Power::gravity, mass * dot(properties.gravity, v), quanta.power);
    tally.largest_speed2 = std::max(tally.largest_speed2, std::bit_cast<std::int64_t>(norm2(v)));
    tally.largest_acceleration2 =
        std::max(tally.largest_acceleration2, std::bit_cast<std::int64_t>(norm2(acceleration)));
    tally.largest_compression =
        std::max(tally.largest_compression, std::bit_cast<std::int64_t>(std::fabs(compression)));
    liquid.acceleration[0][i] = acceleration;
    liquid.rate[0][i] = (1 + compression) * by_motion + by_diffusion;
  }

 private:
  TANDEM_HD Vec3<Real> apart(const dem::PositionRadius<Real>& a, const dem::PositionRadius<Real>& b,
                             dem::Image image) const {
    using Unit = dem::LengthUnit<Real>;
    Vec3<typename Unit::Count> d{Unit::minus(a.x, b.x), Unit::minus(a.y, b.y), Unit::minus(a.z, b.z)};
    if (image != 0) {
      for (int k = 0; k < 3; ++k) {
        if (image & dem::image_above(k)) d[k] = Unit::minus(d[k], period[k]);
        if (image & dem::image_below(k)) d[k] = Unit::minus(d[k], Unit::minus(0, period[k]));
      }
    }
    return {unit.metres(d.x), unit.metres(d.y), unit.metres(d.z)};
  }

  void add_walls(std::uint32_t i, Vec3d v, std::int64_t* sum, std::int64_t& continuity, Tally& tally,
                 BodySum* bodies) const {
    const Vec3d x = centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)));
    NearWalls near;
    walls->find(x, wall_kernel.R, near);
    bool overflow = near.overflow, of_one_body = true;
    bool seen[NearWalls::most];
    const double pressure = static_cast<double>(liquid.state[i].pressure),
                 volume = static_cast<double>(liquid.state[i].volume), mass = properties.mass();
    for (int k = 0; k < near.count; ++k) {
      const NearFacet& f = near.facet[k];
      const double height = dot(x - f.a, f.normal);
      const FacetIntegrals integrals = seen_integrals(x, near, k, wall_kernel, overflow);
      seen[k] = integrals.surface != 0 || integrals.shadow != 0;
      of_one_body = of_one_body && f.body == near.facet[0].body;
      if (!seen[k]) continue;
      const dem::BodyPose& pose = walls->poses()[f.body];
      const Vec3d normal = height < 0 ? -f.normal : f.normal, arm = x - pose.p,
                  v_wall = pose.v + cross(pose.w, arm);
      const WallTerms t =
          wall_terms(wall, integrals, normal, std::fabs(height), v - v_wall, pressure, volume);
      const Vec3d total = dem::rounded(t.total(), quanta.acceleration), torque = mass * cross(arm, total);
      for (int a = 0; a < 3; ++a) {
        const std::int64_t one = dem::to_fixed(total[a], quanta.acceleration);
        sum[a] += one;
        bodies[f.body].acceleration[a] -= one;
        bodies[f.body].torque[a] -= dem::to_fixed(torque[a], quanta.torque);
      }
      continuity += dem::to_fixed(t.continuity, quanta.rate);
      tally.add(Power::viscosity, mass * dot(t.viscous, v - v_wall), quanta.power);
      tally.add(Power::ghost, mass * dot(t.hydrostatic, v - v_wall), quanta.power);
      tally.add(Power::walls, mass * dot(total, v_wall), quanta.power);
    }
    tally.crowded_by_facets += overflow ? 1 : 0;
    if (!of_one_body) add_common_edges(x, near, seen, pressure, volume, tally, bodies);
  }

  // Loads that the ghost liquid behind walls of two bodies passes from one to the other at their common
  // edges. The liquid does not notice them.
  void add_common_edges(Vec3d x, const NearWalls& near, const bool* seen, double pressure, double volume,
                        Tally& tally, BodySum* bodies) const {
    const double mass = properties.mass();
    for (int k = 0; k < near.count; ++k)
      for (int other = 0; other < near.count; ++other) {
        const NearFacet &f = near.facet[k], &g = near.facet[other];
        if (f.body == g.body || !seen[k] || !seen[other]) continue;
        Vec3d strip[4];
        if (!strip_beyond({{f.a, f.b, f.c}, f.normal}, {{g.a, g.b, g.c}, g.normal}, x, 2 * wall_kernel.R,
                          edge_gap * properties.spacing, strip))
          continue;
        const FacetIntegrals integrals = facet_integrals(x, strip, 4, f.normal, wall_kernel);
        const Vec3d normal = dot(x - f.a, f.normal) < 0 ? -f.normal : f.normal;
        const double push = volume * wall.inverse_mass *
                            (2 * pressure * integrals.surface + dot(wall.weight, integrals.moment));
        const Vec3d force = dem::rounded(-push * normal, quanta.acceleration);
        const dem::BodyPose &pose_f = walls->poses()[f.body], &pose_g = walls->poses()[g.body];
        const Vec3d arm_f = x - pose_f.p, arm_g = x - pose_g.p, torque_f = mass * cross(arm_f, force),
                    torque_g = mass * cross(arm_g, force);
        for (int a = 0; a < 3; ++a) {
          const std::int64_t one = dem::to_fixed(force[a], quanta.acceleration);
          bodies[f.body].acceleration[a] += one;
          bodies[g.body].acceleration[a] -= one;
          bodies[f.body].torque[a] += dem::to_fixed(torque_f[a], quanta.torque);
          bodies[g.body].torque[a] -= dem::to_fixed(torque_g[a], quanta.torque);
        }
        const Vec3d apart = pose_f.v + cross(pose_f.w, arm_f) - pose_g.v - cross(pose_g.w, arm_g);
        tally.add(Power::edges, mass * dot(force, apart), quanta.power);
      }
  }
};

}  // namespace tandem::sph
