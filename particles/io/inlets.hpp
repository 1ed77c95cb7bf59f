// The spheres that come in during a run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "particles/io/fill.hpp"

namespace tandem::particles {

// A group of scene.dem.particles whose fill is an inlet.
struct Inlet {
  std::string name;
  scene::InletFill fill;
  std::uint32_t group = 0;     // index in dem.particles
  Vec3d velocity;              // [m/s]
  std::vector<double> due;     // when each sphere is to come in, ascending [s]
  std::vector<double> radius;  // of each sphere [m]
};

// All inlets, in order of their groups, with all spheres of their counts or, without a count, those that are
// due before the scene's end. A sphere is due when the spheres before it have reached the rate: the number at
// time t is the rate times (t - start), rounded up. Error{scene} for more spheres than can be numbered.
std::vector<Inlet> make_inlets(const scene::Scene& scene);

// Appends the spheres of all inlets, at the centres of their boxes.
void append_waiting(const std::vector<Inlet>& inlets, const scene::Scene& scene, Fill& fill);

}  // namespace tandem::particles
