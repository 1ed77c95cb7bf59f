// Rates of one particle from its neighbours and from walls.
#pragma once

#include <cmath>
#include <cstdint>

#include "sph_server/equations/spray.hpp"
#include "sph_server/neighbours/skin.hpp"
#include "sph_server/step/pair_sums.hpp"
#include "sph_server/step/wall_sums.hpp"

namespace tandem::sph {

template <class Real, bool shifting>
struct SumRates {
  static constexpr bool by_teams = false;
  LiquidArrays<Real> liquid;
  const PairSums<Real, shifting>* pairs = nullptr;  // (count)
  const WallSums* walls = nullptr;                  // of the particles beside walls
  const std::uint32_t* before = nullptr;            // how many of those precede each particle (count + 1)
  Quanta quanta;
  Liquid properties;
  double peak = 0;            // W(0) [1/m3]
  double inverse_sound2 = 0;  // 1/c0^2 [s2/m2]
  Vec3d frame;                // velocity relative to which speeds count [m/s]
  // Of the lists: where particles were, how far the frame has moved since, and the skins.
  particles::CentreUnit<Real> centres;
  particles::Periods periods;
  const Vec3d* built_at = nullptr;  // [m]
  Vec3d drift;                      // [m]
  const float* skin = nullptr;      // [m]
  double spare = 0;                 // part of the skins for what is not known here [m]

  template <class Bodies>
  TANDEM_HD void operator()(std::uint32_t i, Tally& tally, Bodies&) const {
    PairSums<Real, shifting> sum = pairs[i];
    for (int a = 0; a < 3; ++a) tally.momentum_rate[a] += sum.acceleration[a];
    tally.burst |= sum.burst;
    const double mass = properties.mass();
    tally.add(Power::viscosity, 0.5 * mass * static_cast<double>(sum.viscous_power), quanta.power);

    WallSums wall;
    if (before[i] != before[i + 1]) wall = walls[before[i]];
    for (int a = 0; a < 3; ++a) sum.acceleration[a] += wall.acceleration[a];
    const Vec3d viscous = sum.viscous.template as<double>() + wall.viscous,
                by_pressure = metric(sum.acceleration, quanta) - viscous - wall.repelled;
    const double compression = liquid.compression[i],
                 pressure = static_cast<double>(liquid.state[i].pressure),
                 volume = static_cast<double>(liquid.state[i].volume);
    const auto neighbours = static_cast<double>(sum.filled);
    const double own = volume * peak;
    const double filled = filled_room(neighbours, own, wall.shadow);
    const double by_motion = particles::from_fixed(sum.continuity + wall.continuity, quanta.rate),
                 by_diffusion = particles::from_fixed(sum.diffusion, quanta.rate);
    const double whole = neighbours + own + wall.shadow;
    const double by_return = closing_rate(properties, compression, tension_share(filled)) +
                             crowding_rate(properties, compression, whole);
    const double elastic = elastic_pressure(properties, compression),
                 bulk = bulk_pressure(properties, compression, liquid.rate[1][i]);
    const double per_rate = elastic * volume / (1 + compression);
    tally.add(Power::bulk_viscosity, -bulk * volume * by_motion, quanta.power);
    tally.add(Power::diffusion, per_rate * by_diffusion, quanta.power);
    // With the rounding of the pressure to what neighbours read.
    tally.add(Power::cavitation, per_rate * by_return - (pressure - elastic - bulk) * volume * by_motion,
              quanta.power);

    const Vec3d v = particles::velocity_of(liquid.velocity[i], liquid.fine_part(i));
    const Vec3d acceleration = properties.gravity + metric(sum.acceleration, quanta);
    tally.add(Power::gravity, mass * dot(properties.gravity, v), quanta.power);
    const double speed2 = norm2(v - frame);
    tally.observe(speed2, norm2(acceleration), std::fabs(compression));
    tally.judge(speed2 * inverse_sound2, std::fabs(compression), quanta.square);
    liquid.acceleration[0][i] = acceleration;
    liquid.rate[0][i] = (1 + compression) * by_motion + by_diffusion + by_return;
    liquid.filled[i] = static_cast<float>(filled);
    liquid.slope[i] = (-properties.density * by_pressure).template as<Real>();
    if constexpr (shifting) liquid.shift[i] = shift_velocity(properties, sum.crowding, wall.surface, whole);
    // The next step extrapolates the acceleration by the whole of its last change at most.
    const double change = norm(acceleration - liquid.acceleration[1][i]);
    tally.stays_for(time_within(skin[i] - spare, moved(i), std::sqrt(speed2) + shift_speed(i),
                                norm(acceleration) + change));
  }

 private:
  TANDEM_HD double moved(std::uint32_t i) const {
    const Vec3d x = centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)));
    return norm(periods.shortest(x - built_at[i] - drift));
  }
  TANDEM_HD double shift_speed(std::uint32_t i) const {
    if constexpr (shifting) return norm(liquid.shift[i].template as<double>());
    return 0;
  }
};

}  // namespace tandem::sph
