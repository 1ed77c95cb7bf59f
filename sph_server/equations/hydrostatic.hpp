// A liquid at rest under gravity g, with the equation of state of Tait (equations/state.hpp):
// dp/d(depth) = rho g.
#pragma once

#include <cmath>

#include "sph_server/equations/liquid.hpp"
#include "sph_server/equations/state.hpp"

namespace tandem::sph {

struct AtRest {
  double pressure = 0;     // [Pa]
  double compression = 0;  // rho/rho0 - 1 [-]
};

// At a depth below the surface [m]: (rho/rho0)^6 = 1 + 6 g depth / c^2. Above the surface the pressure is 0.
inline AtRest at_rest(const Liquid& l, double depth) {
  if (!(depth > 0)) return {};
  const double c2 = l.sound_speed * l.sound_speed;
  const double e = std::expm1(std::log1p(6 * norm(l.gravity) * depth / c2) / 6);
  return {l.density * c2 * tait_pressure(e), e};
}

// The depth below which there is the mass `height` rho0 per area above [m].
inline double depth_at_rest(const Liquid& l, double height) {
  const double c2 = l.sound_speed * l.sound_speed, g = norm(l.gravity);
  return c2 / (6 * g) * std::expm1(6.0 / 7 * std::log1p(7 * g * height / c2));
}
// Its inverse [m].
inline double height_at_rest(const Liquid& l, double depth) {
  const double c2 = l.sound_speed * l.sound_speed, g = norm(l.gravity);
  return c2 / (7 * g) * std::expm1(7.0 / 6 * std::log1p(6 * g * depth / c2));
}

}  // namespace tandem::sph
