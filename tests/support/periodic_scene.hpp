// Spheres in a periodic domain.
#pragma once

#include <nlohmann/json.hpp>

#include "tests/support/particle_run.hpp"

namespace tandem::test {

struct PeriodicScene {
  double radius = 0.0078125, size = 0.25;           // a power of two, and the domain's edge [m]
  std::vector<std::string> axes = {"x", "y", "z"};  // periodic ones
  nlohmann::json dem = nlohmann::json::object();    // more keys of `dem`
  Vec3d gravity;                                    // [m/s2]
  int count = 2;
  double restitution = 0.6, friction = 0.4;

  // The spheres are on a lattice in the middle of the domain.
  std::string json() const {
    const double r = radius, s = size;
    nlohmann::json all = {
        {"skin", r / 4},
        {"materials", {{{"name", "m"}, {"density", 2500}, {"young", 1e6}, {"poisson", 0.25}}}},
        {"pairs", {{{"a", "m"}, {"b", "m"}, {"restitution", restitution}, {"friction", friction}}}},
        {"particles",
         {{{"name", "p"},
           {"material", "m"},
           {"radius", r},
           {"fill",
            {{"type", "lattice"},
             {"min", {0, 0, 0}},
             {"max", {s, s, s}},
             {"spacing", 2.25 * r},
             {"count", count}}}}}},
        {"domain", {{"min", {0, 0, 0}}, {"max", {s, s, s}}, {"periodic", axes}}}};
    all.update(dem);
    return nlohmann::json{{"tandem", "1.0"},
                          {"name", "periodic"},
                          {"gravity", {gravity.x, gravity.y, gravity.z}},
                          {"end_time", 1},
                          {"dem", all}}
        .dump();
  }
  template <class Change>
  ParticleRun run(Change change, unsigned threads = 1) const {
    return ParticleRun(json(), particles::Backend::cpu, threads, change);
  }
};

inline nlohmann::json floor_at(double z) {
  return {{{"name", "floor"},
           {"material", "m"},
           {"shape", {{"type", "plane"}, {"point", {0, 0, z}}, {"normal", {0, 0, 1}}}}}};
}

// A bed in a box without side walls.
inline PeriodicScene bed(const nlohmann::json& more = nlohmann::json::object()) {
  PeriodicScene scene;
  scene.size = 0.125;
  scene.count = 200;
  scene.axes = {"x", "y"};
  scene.gravity = {0, 0, -9.81};
  scene.dem = {{"walls", floor_at(0.0)}};
  scene.dem.update(more);
  return scene;
}

// A slope, so that spheres keep crossing the periodic faces.
inline PeriodicScene chute(const nlohmann::json& options) {
  PeriodicScene scene = bed(options);
  scene.gravity = {4, 1, -9};
  return scene;
}
}  // namespace tandem::test
