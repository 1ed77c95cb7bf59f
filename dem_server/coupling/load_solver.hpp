// The particle solver as a participant of the protocol: it receives the motion of the bodies and returns the
// loads of the particles.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "dem_server/coupling/belts.hpp"
#include "dem_server/coupling/limit_watch.hpp"
#include "dem_server/coupling/sensors.hpp"
#include "dem_server/coupling/traffic.hpp"
#include "dem_server/engine/engine.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/serving/boundary.hpp"
#include "protocol/participant/solver.hpp"

namespace tandem::particles {
struct Fill;
}

namespace tandem::dem {

class Solver final : public protocol::LoadSolver {
 public:
  // With `ranks`, one of several that execute the same orders.
  explicit Solver(Ranks* ranks = nullptr) : ranks_(ranks) {}

  protocol::Configured configure(const protocol::Configuration& configuration) override;
  const protocol::LoadSet& advance(const protocol::MotionSet& motion) override;
  const protocol::TangentSet& linearise() override;
  const protocol::ParticlesFrame& observe() override;
  void snapshot() override;
  const protocol::ParticlesFrame& read_snapshot() override;
  void save() override;
  void restore() override;
  void checkpoint(const protocol::Checkpoint& file) override;
  void resume(const protocol::Checkpoint& file) override;
  protocol::Report report() override;
  std::uint64_t capabilities() const override {
    return LoadSolver::capabilities() | protocol::can_linearise | protocol::can_checkpoint |
           protocol::can_measure | protocol::can_observe_contacts | protocol::can_observe_walls |
           protocol::can_snapshot;
  }

 private:
  // The state that the solver keeps from window to window besides the engine's: a rollback restores it, and a
  // restart file holds it.
  struct Memory {
    Nanoseconds now;
    std::uint64_t micro_steps = 0;
    std::uint64_t sphere_steps = 0;  // spheres times micro steps, since this process began
    std::uint64_t lost_reported = 0;
    std::vector<LastMotion> bodies;
    LimitWatch::Record limits;
    std::vector<Traffic::Counts> traffic;
    std::vector<Belts::Record> belts;
    std::vector<FlowRecord> sensors;
  };

  // More than any sound window has. The limit exists because the loads of each step are stored.
  static constexpr double most_steps = 1e7;

  // `fill` has the group of each sphere, for messages.
  void choose_micro_step(const Spheres& spheres, const Fill& fill);
  // Number of micro steps in a window, such that none is longer than requested, up to rounding.
  double steps_in(double length) const;
  double longest_window() const;  // [s]
  // The micro step in the longest window [s].
  double step_taken() const { return longest_window() / steps_in(longest_window()); }
  void expect_steps(const std::string& chosen_for, const std::string& remedy) const;
  void expect_ranks() const;
  Backend backend_of_ranks(const std::string& wanted) const;
  // `cells`: memory of the domain's cells [bytes]. Returns the memory of the engine [bytes].
  std::size_t check_memory(const EngineSetup& setup, std::size_t cells);
  void warn(const std::string& sentence);
  std::string precision_name() const;
  const WindowOutcome& advance_engine();
  void pass_inlets_and_outlets(Nanoseconds now);
  double farthest_contact(Vec3d origin) const;
  void set_paths(const protocol::MotionSet& motion);
  std::vector<double> measure_at_start();
  // Sets poses_ to those at the end of the last window, or of the scene before the first one.
  void set_last_poses();
  std::vector<float> contacts_of_spheres();
  void observe_contacts(protocol::ParticlesFrame& frame);
  std::vector<double> contacts_of_bodies();
  void record_loads(const Window& window, const WindowOutcome& outcome);
  protocol::BodyLoad load_of(std::size_t body, double length, const WindowOutcome& outcome) const;

  Ranks* ranks_;  // null: none
  scene::Scene scene_;
  Surface surface_;
  EngineChoice choice_;
  std::unique_ptr<Engine> engine_;
  double largest_step_ = 0;  // micro step that was requested, or chosen [s]
  double critical_ = 0;      // see laws/step_limits.hpp [s]
  double collision_ = 0;     // duration of the fastest collision to expect [s]; infinite: none
  LimitWatch watch_;
  Traffic traffic_;
  Belts belts_;
  Sensors sensors_;
  std::size_t spheres_ = 0;
  double skin_ = 0;  // of the last neighbour list [m]
  // With walls, including the ground; a belt has an entry of its own after that of its body.
  std::vector<BoundaryBody> bodies_;
  Memory memory_, saved_;
  std::vector<PreparedPath> paths_;
  WindowPlan plan_;
  double solver_seconds_ = 0, solver_cpu_seconds_ = 0;  // in advance [s]
  std::vector<std::string> warnings_;
  std::vector<BodyPose> poses_;  // of bodies_, between two windows
  protocol::LoadSet loads_;
  protocol::TangentSet tangents_;
  protocol::ParticlesFrame frame_, snapshot_;
};

}  // namespace tandem::dem
