// A particle engine on a scene given as JSON, for tests of laws, lists and back ends, without protocol and
// processes.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/scene/parse.hpp"
#include "dem_server/engine/engine.hpp"
#include "particles/io/fill.hpp"

namespace tandem::test {

struct ParticleRun {
  scene::Scene scene;
  particles::Surface surface;
  particles::Spheres spheres;
  particles::SkinRange skins;
  std::unique_ptr<dem::Engine> engine;

  // `change` may edit the spheres before the engine receives them (positions, velocities, spins); `meshes`
  // are those of walls, by name.
  template <class Change>
  ParticleRun(const std::string& json, particles::Backend backend, unsigned threads, Change change,
              const std::vector<NamedMesh>& meshes = {}, particles::Ranks* ranks = nullptr)
      : scene(scene::parse(json, "test")) {
    const particles::Fill fill = particles::make_fill(scene, {});
    spheres.position = fill.position;
    spheres.velocity = fill.velocity;
    spheres.spin.resize(fill.position.size());
    spheres.radius = fill.radius;
    spheres.material = fill.material;
    for (std::size_t i = 0; i < fill.position.size(); ++i)
      spheres.id.push_back(static_cast<std::uint32_t>(i));
    change(spheres);
    double largest = 0;
    for (const double r : spheres.radius) largest = std::max(largest, r);
    skins = particles::skins_of(*scene.dem, spheres.radius);
    surface =
        particles::make_surface(scene, meshes, largest + skins.largest, particles::make_fixed(scene, {}));
    dem::EngineSetup setup{scene, surface, spheres, skins, threads};
    setup.ranks = ranks;
    engine = dem::make_engine(dem::choose_engine(scene, backend), setup);
  }
  explicit ParticleRun(const std::string& json, particles::Backend backend = particles::Backend::cpu,
                       unsigned threads = 1)
      : ParticleRun(json, backend, threads, [](particles::Spheres&) {}) {}

  // Runs `steps` micro steps of dt [s] with all bodies at rest at their poses of the scene; wall_jump [m] as
  // in WindowPlan.
  const dem::WindowOutcome& advance(std::uint32_t steps, double dt, double wall_jump = 0) {
    std::vector<particles::PreparedPath> paths;
    for (const BodyId body : surface.boundary_bodies) {
      const Pose pose = body == ground ? Pose{} : scene.mbd->bodies[body.value].pose;
      paths.push_back(particles::prepare_path({pose, pose, {}, {}}, steps * dt));
    }
    return engine->advance({steps, dt, paths, 0, wall_jump});
  }
  particles::Spheres state() const {
    particles::Spheres s;
    engine->download(s);
    return s;
  }
};

// The whole state of an engine, by name.
using Arrays = std::map<std::string, std::vector<std::byte>>;
inline Arrays written(const ParticleRun& run) {
  Arrays arrays;
  run.engine->write([&](const std::string& name, std::span<const std::byte> bytes) {
    EXPECT_TRUE(arrays.emplace(name, std::vector(bytes.begin(), bytes.end())).second) << name;
  });
  return arrays;
}

template <class T>
std::vector<T> array_of(const Arrays& arrays, const std::string& name) {
  const std::vector<std::byte>& bytes = arrays.at(name);
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

// Ids by sphere index, in mixed precision: with a law with friction they are in the spins.
inline std::vector<std::uint32_t> ids_of(const Arrays& arrays) {
  std::vector<std::uint32_t> ids = array_of<std::uint32_t>(arrays, "id");
  const auto side =
      array_of<particles::WindowProgress>(arrays, "host_window_progress").front().progress[0].state_side;
  for (const auto& spin : array_of<dem::Spin<float>>(arrays, side == 0 ? "spin.0" : "spin.1"))
    ids.push_back(spin.id);
  return ids;
}

// The largest distance between the positions of a sphere in two states [m].
inline double largest_distance(const particles::Spheres& a, const particles::Spheres& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, norm(a.position[i] - b.position[i]));
  return worst;
}

}  // namespace tandem::test
