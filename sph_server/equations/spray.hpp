// Particles whose kernel is not filled: spray, drops, rims of jets. A liquid that can separate bears no
// tension, so that neither walls nor neighbours pull them; and their density returns to that of the liquid at
// rest, so that the next wall or neighbour pushes them at once.
#pragma once

#include "common/host_device.hpp"
#include "sph_server/equations/liquid.hpp"
#include "sph_server/equations/state.hpp"

namespace tandem::sph {

// Filled part of the kernel, by particles and by the ghost liquid of walls [-]. One particle alone fills
// 0.12, an edge of a cube of liquid 0.54, a free surface 0.74. Up to `spray_below` a particle bears no
// tension, above `liquid_above` all of it.
inline constexpr double spray_below = 0.4, liquid_above = 0.65;

// Share of a tension that a particle bears: smooth in `filled`, so that nothing switches [-].
TANDEM_HD inline double tension_share(double filled) {
  const double x = (filled - spray_below) / (liquid_above - spray_below);
  return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x);
}

// Pressure without the bound on tension: that of the equation of state, and that of the bulk viscosity for
// the rate of the compression [Pa].
TANDEM_HD inline double elastic_pressure(const Liquid& l, double compression) {
  return l.density * l.sound_speed * l.sound_speed * tait_pressure(compression);
}
TANDEM_HD inline double bulk_pressure(const Liquid& l, double compression, double rate) {
  return l.bulk_viscosity * l.density * l.sound_speed * l.h() * rate / (1 + compression);
}
TANDEM_HD inline double borne(double pressure, double share) {
  return pressure < 0 ? share * pressure : pressure;
}

// Rate at which an expanded particle returns to the density at rest [1/s], in four times the time in which
// sound crosses a smoothing length.
TANDEM_HD inline double closing_rate(const Liquid& l, double compression, double share) {
  return compression < 0 ? -(1 - share) * compression * l.sound_speed / (4 * l.h()) : 0;
}

}  // namespace tandem::sph
