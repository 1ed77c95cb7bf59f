// A multibody scene from its start to its end, as a coordinator would run it.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd::machines {

// `load`: force on each boundary body along y [N].
struct WholeRun {
  MbdSolver solver;

  explicit WholeRun(const scene::Scene& scene, double load = 0) {
    const protocol::Configured configured = solver.configure(scene);
    const std::int64_t window = to_nanoseconds(scene.coupling.window).count,
                       end = to_nanoseconds(scene.end_time).count;
    for (std::int64_t t = 0; t < end; t += window) {
      protocol::LoadSet loads;
      loads.window = {static_cast<std::uint64_t>(t / window), {t}, {std::min(t + window, end)}};
      for (const auto& body : configured.boundary) {
        loads.bodies.emplace_back();
        loads.bodies.back().body = body.body;
        loads.bodies.back().mean.force = {0, load, 0};
      }
      solver.advance(loads);
    }
  }
  nlohmann::json facts() { return nlohmann::json::parse(solver.report().facts); }
};

// A shipped scene with its step times `factor`.
inline scene::Scene with_step(const std::string& name, double factor) {
  scene::Scene scene = shipped(name);
  *scene.mbd->integrator.step *= factor;
  return scene;
}

}  // namespace tandem::mbd::machines
