// Particles whose kernel is not filled: spray, drops, rims of jets; and those whose kernel is overfull. A
// liquid that can separate bears no tension, so that neither walls nor neighbours pull them; and their
// density returns to that of the liquid at rest, so that the next wall or neighbour pushes them at once. A
// liquid that is torn off a wall cavitates where the tension is larger than any suction of a flow.
#pragma once

#include "common/host_device.hpp"
#include "sph_server/equations/limits.hpp"
#include "sph_server/equations/liquid.hpp"
#include "sph_server/equations/state.hpp"

namespace tandem::sph {

// Part of the room in the kernel that the walls and the particle itself leave which its neighbours fill [-].
// Walls do not count as liquid: a row of drops that leaves a wall is spray. neighbours, own, shadow: parts of
// the kernel that neighbours, the particle, and the ghost liquid of walls fill [-].
TANDEM_HD inline double filled_room(double neighbours, double own, double shadow) {
  constexpr double least = 0.05;  // narrower corners hold no neighbour
  const double room = 1 - own - shadow;
  return neighbours / (room > least ? room : least);
}

// One particle alone has 0, an edge of a cube of liquid 0.48, a free surface 0.70, also at a wall across it.
// Up to `spray_below` a particle bears no tension, above `liquid_above` all of it.
inline constexpr double spray_below = 0.32, liquid_above = 0.6;

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
// Largest tension of a liquid in units of rho0 c0^2, and its expansion under it [-]: the stagnation pressure
// at the largest speed for which walls and the equation of state are made.
inline constexpr double largest_tension = 0.5 * largest_mach * largest_mach;

TANDEM_HD inline double borne(const Liquid& l, double pressure, double share) {
  const double most = largest_tension * l.density * l.sound_speed * l.sound_speed;
  return pressure >= 0 ? pressure : share * (pressure > -most ? pressure : -most);
}

// Rate at which a particle returns from an expansion that it does not bear [1/s], in four times the time in
// which sound crosses a smoothing length.
TANDEM_HD inline double closing_rate(const Liquid& l, double compression, double share) {
  if (!(compression < 0)) return 0;
  const double borne = share * (compression > -largest_tension ? compression : -largest_tension);
  return (borne - compression) * l.sound_speed / (4 * l.h());
}

// The rate of compression by motion is not exact beside walls, so that particles may gather in corners
// without a rise of their density. `whole`: what neighbours, the particle itself and walls fill of its
// kernel, 1 in a liquid at rest and at most 1.1 beside walls in a flow. Above `crowded` the density rises,
// within the time in which expansions close, by as much as the kernel is overfull, up to a pressure of
// `largest_crowding` rho0 c0^2 that moves the particles apart [1/s].
inline constexpr double crowded = 1.15, largest_crowding = 0.01;
TANDEM_HD inline double crowding_rate(const Liquid& l, double compression, double whole) {
  const double overfull = whole - crowded, borne = overfull < largest_crowding ? overfull : largest_crowding;
  if (!(borne > 0 && borne > compression)) return 0;
  return (borne - compression) * l.sound_speed / (4 * l.h());
}

}  // namespace tandem::sph
