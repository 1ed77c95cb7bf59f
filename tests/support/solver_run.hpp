// The particle solver, accessed through the protocol window by window, and the balance of its momentum.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "common/log.hpp"
#include "dem_server/coupling/make_solver.hpp"

namespace tandem::test {

struct SolverRun {
  static constexpr Nanoseconds window{1'000'000};

  std::unique_ptr<protocol::LoadSolver> solver;
  nlohmann::json configured;
  Nanoseconds now;
  std::uint64_t windows = 0;
  // Momentum: residual of the particles' balance, and sum of what was exchanged [N s]
  Vec3d open;
  double exchanged = 0;
  std::uint64_t lost = 0;
  std::vector<double> sensed;  // at the end of the last window

  SolverRun(const nlohmann::json& scene, const std::string& origin, unsigned threads, const char* backend,
            std::unique_ptr<protocol::LoadSolver> made = dem::make_solver())
      : solver(std::move(made)) {
    log::setup("test", "error");
    protocol::Configuration c;
    c.scene_text = scene.dump();
    c.origin = origin;
    c.backend = backend;
    c.threads = threads;
    configured = nlohmann::json::parse(solver->configure(c).facts);
  }
  // Runs one window in which `bodies` have these motions.
  void advance_window(const std::vector<protocol::BodyMotion>& bodies) {
    protocol::MotionSet motion;
    motion.window = {windows++, now, now + window};
    motion.bodies = bodies;
    const protocol::LoadSet& loads = solver->advance(motion);
    now = motion.window.end;
    const protocol::ParticleAccount& a = loads.account;
    Vec3d walls;
    for (const protocol::BodyLoad& load : loads.bodies) walls += -motion.window.length() * load.mean.force;
    open += a.momentum_end - a.momentum_begin + a.lost_momentum - a.gravity_impulse - walls;
    exchanged += norm(a.lost_momentum) + norm(a.gravity_impulse) + norm(walls);
    lost = a.lost_particles;
    sensed = loads.sensors;
  }
  nlohmann::json report() { return nlohmann::json::parse(solver->report().facts); }
  std::string hash() { return report()["dem_state_hash"]; }
};

}  // namespace tandem::test
