// What sensors ask of the particles between steps: sums over a region, and the particles near a line.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "particles/base/fixed_point.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/state/centre.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/step/arrays.hpp"

namespace tandem::sph {

// Sums of integers, with the same bits for every number of threads and every back end. Places are those
// relative to the middle of the region.
struct RegionTally {
  std::uint64_t count = 0;
  std::int64_t expansion = 0, place[3]{}, velocity[3]{}, squares = 0, along = 0;
  TANDEM_HD void add(const RegionTally& b) {
    count += b.count;
    expansion += b.expansion;
    for (int a = 0; a < 3; ++a) {
      place[a] += b.place[a];
      velocity[a] += b.velocity[a];
    }
    squares += b.squares;
    along += b.along;
  }
};

struct RegionQuanta {
  particles::Quantum expansion, place, velocity, square, along;

  // Of `count` particles, none of which has more than this speed [m/s] and compression [-].
  static RegionQuanta of(const particles::MeasuredRegion& region, std::size_t count, double speed,
                         double compression) {
    const auto range = [count](double most) {
      return particles::Quantum::for_range(static_cast<double>(count) * std::max(most, 1e-150));
    };
    const double extent = norm(region.half),
                 wall = norm(region.body.v) + norm(region.body.w) * (norm(region.p - region.body.p) + extent);
    return {range(compression / (1 - compression)), range(extent), range(speed), range(speed * speed),
            range(speed + wall)};
  }
};

template <class Real>
struct AddInRegion {
  LiquidArrays<Real> liquid;
  particles::CentreUnit<Real> centres;
  particles::MeasuredRegion region;
  RegionQuanta quanta;

  TANDEM_HD void operator()(std::uint32_t i, RegionTally& sum) const {
    const particles::FinePart<Real> fine = liquid.fine_part(i);
    const Vec3d x = centres.metres(centres.joined(liquid.position[i], fine));
    if (!region.contains(x)) return;
    const Vec3d v = particles::velocity_of(liquid.velocity[i], fine), from = x - region.p;
    const Vec3d of_body = region.body.v + cross(region.body.w, x - region.body.p);
    const double e = liquid.compression[i];
    ++sum.count;
    sum.expansion += particles::to_fixed(-e / (1 + e), quanta.expansion);
    for (int a = 0; a < 3; ++a) {
      sum.place[a] += particles::to_fixed(from[a], quanta.place);
      sum.velocity[a] += particles::to_fixed(v[a], quanta.velocity);
    }
    sum.squares += particles::to_fixed(norm2(v), quanta.square);
    sum.along += particles::to_fixed(dot(region.flow, v - of_body), quanta.along);
  }
};

// The particles less than `radius` from the line through `from` along a unit vector; where that is zero, from
// the point.
struct NearLine {
  Vec3d from, along;  // [m], [-]
  double radius = 0;  // [m]
  particles::Periods periods;
  TANDEM_HD bool has(Vec3d x) const {
    const Vec3d d = periods.shortest(x - from);
    return norm2(d - dot(d, along) * along) < radius * radius;
  }
};
struct NearCount {
  std::uint32_t particles = 0;
  TANDEM_HD void add(const NearCount& b) { particles += b.particles; }
};
template <class Real>
struct MarkNearLine {
  LiquidArrays<Real> liquid;
  particles::CentreUnit<Real> centres;
  NearLine line;
  std::uint32_t* mark = nullptr;  // 1: one of them
  TANDEM_HD void operator()(std::uint32_t i, NearCount& sum) const {
    mark[i] = line.has(centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)))) ? 1 : 0;
    sum.particles += mark[i];
  }
};
struct NearParticle {
  std::uint32_t number = 0;
  Vec3d x, v, slope;
  double compression = 0, pressure = 0;
};
template <class Real>
struct GatherNear {
  LiquidArrays<Real> liquid;
  particles::CentreUnit<Real> centres;
  const std::uint32_t* before = nullptr;  // number of them before each particle (particles + 1)
  NearParticle* near = nullptr;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (before[i] == before[i + 1]) return;
    const particles::FinePart<Real> fine = liquid.fine_part(i);
    near[before[i]] = {liquid.number[i],
                       centres.metres(centres.joined(liquid.position[i], fine)),
                       particles::velocity_of(liquid.velocity[i], fine),
                       liquid.slope[i].template as<double>(),
                       liquid.compression[i],
                       static_cast<double>(liquid.state[i].pressure)};
  }
};

}  // namespace tandem::sph
