// Runs of a particle participant for the checks.
#pragma once

#include <vector>

#include "coordinator/scene/scene_spheres.hpp"
#include "launch/conform/check.hpp"
#include "launch/conform/sample.hpp"

namespace tandem::conform {

inline double mass_of(const Examination& e, std::size_t group) {
  const scene::Dem& dem = e.scene().dem.value();
  return launch::sphere_mass(dem.materials[dem.particles[group].material.value].density,
                             dem.particles[group].radius_min);
}

// Element i of an array of a frame.
inline Vec3d vector_of(const std::vector<double>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}
inline Vec3d vector_of(const std::vector<float>& values, std::size_t i) {
  return Vec3f{values[3 * i], values[3 * i + 1], values[3 * i + 2]}.as<double>();
}

// A load that is left out is zero.
inline protocol::BodyLoad load_or_zero(const protocol::LoadSet& loads, std::uint32_t body) {
  const protocol::BodyLoad* found = load_on(loads.bodies, body);
  return found ? *found : protocol::BodyLoad{};
}

// The scene's bodies at rest for so many windows; the last answer.
inline protocol::LoadSet rest_windows(Session& session, const scene::Scene& scene, int count,
                                      double length = H) {
  protocol::LoadSet loads;
  const auto paths = paths_at_rest(scene);
  for (int i = 0; i < count; ++i) loads = session.advance(paths, length);
  return loads;
}

}  // namespace tandem::conform
