// What sensors and balances measure of a liquid between steps.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "sph_server/engine/liquid_engine_of.hpp"

namespace tandem::sph {

template <class Exec, class Real, bool shifting>
LiquidTotals LiquidEngineOf<Exec, Real, shifting>::totals() const {
  const Liquid& l = setup_.liquid;
  // Sums of integers cannot show a value that is not a number.
  if (!(std::isfinite(figures_.largest_speed) && figures_.largest_compression < 1))
    throw Error(ErrorCode::numerics,
                "the liquid flies apart: a particle has a speed of " +
                    scene::rounded(figures_.largest_speed) + " m/s, and one a density that is off by " +
                    scene::rounded(figures_.largest_compression),
                "liquid", "give a larger sound_speed, or a smaller spacing of the liquid");
  const TotalQuanta q =
      TotalQuanta::of(count_, figures_.largest_speed + norm(frame_velocity()), figures_.largest_compression);
  const Totals t = exec_.template reduce<Totals>(count(), AddTotals<Real>{liquid_, q});
  LiquidTotals all;
  for (int a = 0; a < 3; ++a) all.momentum[a] = l.mass() * particles::from_fixed(t.momentum[a], q.velocity);
  all.kinetic = 0.5 * l.mass() * particles::from_fixed(t.kinetic, q.square);
  all.compression = l.mass() * l.sound_speed * l.sound_speed * particles::from_fixed(t.compression, q.energy);
  all.volume =
      l.mass() / l.density * (static_cast<double>(count_) + particles::from_fixed(t.expansion, q.expansion));
  return all;
}

template <class Exec, class Real, bool shifting>
particles::RegionSums LiquidEngineOf<Exec, Real, shifting>::sums_in(
    const particles::MeasuredRegion& region) const {
  const Liquid& l = setup_.liquid;
  const RegionQuanta q = RegionQuanta::of(region, count_, figures_.largest_speed + norm(frame_velocity()),
                                          figures_.largest_compression);
  const RegionTally t =
      exec_.template reduce<RegionTally>(count(), AddInRegion<Real>{liquid_, centres_, region, q});
  particles::RegionSums sums;
  const double n = static_cast<double>(t.count);
  sums.count = t.count;
  sums.mass = n * l.mass();
  sums.volume = l.mass() / l.density * (n + particles::from_fixed(t.expansion, q.expansion));
  for (int a = 0; a < 3; ++a) {
    sums.moment[a] = l.mass() * (n * region.p[a] + particles::from_fixed(t.place[a], q.place));
    sums.momentum[a] = l.mass() * particles::from_fixed(t.velocity[a], q.velocity);
  }
  sums.kinetic_energy = 0.5 * l.mass() * particles::from_fixed(t.squares, q.square);
  sums.flow_momentum = l.mass() * particles::from_fixed(t.along, q.along);
  return sums;
}

template <class Exec, class Real, bool shifting>
LiquidState LiquidEngineOf<Exec, Real, shifting>::near_line(Vec3d from, Vec3d along, double radius) const {
  exec_.grow(near_before_, count_ + 1);
  exec_.zero(near_before_, count_ + 1);
  const NearLine line{from, along, radius, setup_.periods};
  const std::uint32_t n = exec_
                              .template reduce<NearCount>(
                                  count(), MarkNearLine<Real>{liquid_, centres_, line, near_before_.data()})
                              .particles;
  std::vector<NearParticle> near(n);
  if (n > 0) {
    exec_.grow(near_line_, n);
    exec_.exclusive_sum(near_before_, count() + 1);
    exec_.for_each(count(), GatherNear<Real>{liquid_, centres_, near_before_.data(), near_line_.data()});
    exec_.download(near_line_, std::span(near));
    std::ranges::sort(near, {}, &NearParticle::number);
  }
  LiquidState s;
  for (const NearParticle& p : near) {
    s.position.push_back(p.x);
    s.velocity.push_back(p.v);
    s.compression.push_back(p.compression);
    s.pressure.push_back(p.pressure);
    s.slope.push_back(p.slope);
  }
  return s;
}

template <class Exec, class Real, bool shifting>
EnergyBalance LiquidEngineOf<Exec, Real, shifting>::energies() const {
  const LiquidTotals now = totals();
  EnergyBalance e;
  e.kinetic = now.kinetic;
  e.compression = now.compression;
  const auto of = [this](Power p) { return work_.of[static_cast<int>(p)]; };
  e.gravity = of(Power::gravity);
  e.viscosity = of(Power::viscosity);
  e.bulk_viscosity = of(Power::bulk_viscosity);
  e.diffusion = of(Power::diffusion);
  e.cavitation = of(Power::cavitation);
  e.ghost = of(Power::ghost);
  e.repulsion = of(Power::repulsion);
  e.walls = of(Power::walls);
  e.edges = of(Power::edges);
  return e;
}

}  // namespace tandem::sph
