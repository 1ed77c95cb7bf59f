// Runs of a multibody participant for the checks.
#pragma once

#include <memory>
#include <vector>

#include "launch/conform/check.hpp"
#include "launch/conform/sample.hpp"

namespace tandem::conform {

inline constexpr int run_windows = 40;  // of a run
inline constexpr double position_share =
    1e-2;  // tolerance of a position against its closed form, and of angular momentum
inline constexpr double velocity_share = 1e-3;  // tolerance of a velocity
inline constexpr double rounding = 1e-9;

// The motions of a run under constant loads: one per window.
struct MotionRun {
  std::unique_ptr<Session> session;
  std::vector<protocol::BodyLoad> loads;
  std::vector<protocol::MotionSet> motions;

  double time() const { return session->time(); }
  const protocol::BodyMotion& first(std::uint32_t body) const { return motion_of(motions.front(), body); }
  const protocol::BodyMotion& last(std::uint32_t body) const { return motion_of(motions.back(), body); }
};

inline MotionRun run_under(Examination& e, double load, int count, double length = H) {
  MotionRun run{e.open(), {}, {}};
  run.loads = sample_loads(e.scene(), run.session->configured().boundary, load);
  for (int i = 0; i < count; ++i) run.motions.push_back(run.session->advance(run.loads, length));
  return run;
}

inline const scene::Body& body_of(const Examination& e, std::uint32_t body) {
  return e.scene().mbd.value().bodies.at(body);
}

template <class Each>
void for_each_body(const Examination& e, Each each) {
  for (const std::uint32_t body : boundary_bodies(e.scene())) each(body, body_of(e, body));
}

}  // namespace tandem::conform
