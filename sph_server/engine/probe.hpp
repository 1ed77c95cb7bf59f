// What is measured of a liquid at a point and on a line.
#pragma once

#include <vector>

#include "particles/geometry/periods.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {

// Refers to its arguments. Particles behind a wall do not count, seen from a fiftieth of a spacing in front
// of the point, so that a point on a wall sees the liquid on both of its sides.
class Probe {
 public:
  Probe(const LiquidState& state, const Liquid& liquid, const particles::Periods& periods, const Walls& walls)
      : state_(state), liquid_(liquid), periods_(periods), walls_(walls) {}

  // Mean of the pressures that the particles within the support of the kernel W have at x by their own
  // gradients, weighted by volume times W: exact where the pressure is linear. 0 without such particles [Pa].
  double pressure_at(Vec3d x) const;

  // The largest s at which the sum of volume times W at from + s along is half of what a space full of liquid
  // has there, without the part of the kernel that walls hide. A drop alone has less. 0 where there is none
  // [m]. along: a unit vector.
  double level_on(Vec3d from, Vec3d along) const;

 private:
  // Facets, in the world, that may be within the support of x.
  std::vector<particles::Facet> facets_near(Vec3d x) const;
  // Is none of them between x and y?
  bool sees(const std::vector<particles::Facet>& near, Vec3d x, Vec3d y) const;
  double volume(std::size_t particle) const {
    return liquid_.mass() / liquid_.density / (1 + state_.compression[particle]);
  }
  // Is the sum of volume times W over `particles` at x at least half of the part of W that walls leave?
  bool is_liquid(Vec3d x, const std::vector<std::size_t>& particles) const;

  const LiquidState& state_;
  const Liquid& liquid_;
  const particles::Periods& periods_;
  const Walls& walls_;
};

}  // namespace tandem::sph
