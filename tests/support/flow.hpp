// Scenes in which spheres come in and go out, and the particle solver on them as the protocol sees it.
#pragma once

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "common/log.hpp"
#include "dem_server/coupling/make_solver.hpp"

namespace tandem::test {

// A shower of spheres of `radius` with this inlet, from z = 0.4 to 0.5, and what else `dem` has.
inline nlohmann::json shower(const nlohmann::json& inlet,
                             const nlohmann::json& dem = nlohmann::json::object(),
                             nlohmann::json radius = 0.01) {
  nlohmann::json fill = {{"type", "inlet"}, {"min", {-0.1, -0.1, 0.4}}, {"max", {0.1, 0.1, 0.5}}};
  fill.update(inlet);
  nlohmann::json all = {{"materials",
                         {{{"name", "glass"},
                           {"density", 2500},
                           {"young", 1e7},
                           {"poisson", 0.25},
                           {"restitution", 0.5},
                           {"friction", 0.4}}}},
                        {"particles",
                         {{{"name", "rain"},
                           {"material", "glass"},
                           {"radius", radius},
                           {"velocity", {0, 0, -1}},
                           {"fill", fill}}}},
                        {"domain", {{"min", {-0.2, -0.2, -0.5}}, {"max", {0.2, 0.2, 0.6}}}}};
  all.update(dem);
  return {{"tandem", "1.0"},
          {"name", "shower"},
          {"gravity", {0, 0, 0}},
          {"end_time", 0.5},
          {"coupling", {{"window", 0.001}}},
          {"dem", all}};
}

struct Rain {
  std::unique_ptr<protocol::LoadSolver> solver = dem::make_solver();
  nlohmann::json configured;
  Nanoseconds now;
  std::uint64_t windows = 0;
  // momentum: what the particles' books leave open, and what was exchanged [N s]
  Vec3d open;
  double exchanged = 0;
  std::uint64_t lost = 0;

  explicit Rain(const nlohmann::json& scene, unsigned threads = 1, const char* backend = "cpu") {
    log::setup("test", "error");
    protocol::Configuration c;
    c.scene_text = scene.dump();
    c.origin = "shower.json";
    c.backend = backend;
    c.threads = threads;
    configured = nlohmann::json::parse(solver->configure(c).facts);
  }
  void advance(int count) {
    for (int i = 0; i < count; ++i) {
      protocol::MotionSet motion;
      motion.window = {windows++, now, now + Nanoseconds{1'000'000}};
      const protocol::LoadSet& loads = solver->advance(motion);
      now = motion.window.end;
      const protocol::ParticleAccount& a = loads.account;
      Vec3d walls;
      for (const protocol::BodyLoad& load : loads.bodies) walls += -1e-3 * load.mean.force;
      open += a.momentum_end - a.momentum_begin + a.lost_momentum - a.gravity_impulse - walls;
      exchanged += norm(a.lost_momentum) + norm(a.gravity_impulse) + norm(walls);
      lost = a.lost_particles;
    }
  }
  const protocol::ParticlesFrame& frame() { return solver->observe(); }
  nlohmann::json report() { return nlohmann::json::parse(solver->report().facts); }
  std::string hash() { return report()["dem_state_hash"]; }
};

// Spheres that fall on a heap in a tray, from which they run off: contacts, waking, parking, all at once.
inline nlohmann::json heap(const std::string& options = "") {
  nlohmann::json walls = {{{"name", "tray"},
                           {"material", "glass"},
                           {"position", {0, 0, 0.25}},
                           {"shape", {{"type", "box"}, {"size", {0.3, 0.1, 0.1}}, {"open", {"+z", "+x"}}}}}};
  nlohmann::json end = {
      {{"name", "end"}, {"region", {{"type", "box"}, {"min", {0.07, -1, -1}}, {"max", {1, 1, 1}}}}}};
  nlohmann::json dem = {{"walls", walls}, {"outlets", end}};
  if (!options.empty()) dem.update(nlohmann::json::parse(options));
  nlohmann::json scene = shower({{"rate", 3000}, {"min", {-0.14, -0.04, 0.25}}, {"max", {0.1, 0.04, 0.35}}},
                                dem, {0.008, 0.012});
  scene["gravity"] = {12, 0, -20};
  return scene;
}

}  // namespace tandem::test
