// Scenes with inlets and outlets, and the particle solver on them, accessed through the protocol.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/solver_run.hpp"

namespace tandem::test {

// Spheres of `radius` fall from this inlet, from z = 0.4 to 0.5; `dem` holds further keys.
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

struct Rain : SolverRun {
  explicit Rain(const nlohmann::json& scene, unsigned threads = 1, const char* backend = "cpu")
      : SolverRun(scene, "shower.json", threads, backend) {}
  void advance(int count) {
    for (int i = 0; i < count; ++i) advance_window({});
  }
  const protocol::ParticlesFrame& frame() { return solver->observe(); }
};

// Spheres fall on a heap in a tray and roll off it: contacts, spheres coming in and parking at the same time.
// At the start this many more spheres are in the region of an outlet.
inline constexpr int gone_at_once = 600;
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
  nlohmann::json gone = scene["dem"]["particles"][0];
  gone["name"] = "gone";
  gone["radius"] = 0.004;
  gone["fill"] = {{"type", "lattice"},
                  {"min", {0.08, -0.15, 0.4}},
                  {"max", {0.19, 0.15, 0.59}},
                  {"spacing", 0.01},
                  {"count", gone_at_once}};
  scene["dem"]["particles"].push_back(gone);
  return scene;
}

}  // namespace tandem::test
