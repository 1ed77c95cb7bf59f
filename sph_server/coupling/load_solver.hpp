// The solver of liquids as a participant of the protocol: it receives the motion of the bodies and returns
// the loads of the liquid.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "particles/serving/boundary.hpp"
#include "protocol/participant/solver.hpp"
#include "sph_server/coupling/liquid_start.hpp"
#include "sph_server/coupling/sensors.hpp"
#include "sph_server/coupling/traffic.hpp"
#include "sph_server/engine/liquid_engine.hpp"

namespace tandem::sph {

class Solver final : public protocol::LoadSolver {
 public:
  protocol::Role role() const override { return protocol::Role::sph; }
  protocol::Configured configure(const protocol::Configuration& configuration) override;
  const protocol::LoadSet& advance(const protocol::MotionSet& motion) override;
  const protocol::ParticlesFrame& observe() override;
  // The responses only: contacts, to which stiffness and damping belong, a liquid has none.
  const protocol::TangentSet& linearise() override;
  void snapshot() override;
  const protocol::ParticlesFrame& read_snapshot() override;
  void save() override;
  void restore() override;
  void checkpoint(const protocol::Checkpoint& file) override;
  void resume(const protocol::Checkpoint& file) override;
  protocol::Report report() override;
  std::uint64_t capabilities() const override {
    return LoadSolver::capabilities() | protocol::can_checkpoint | protocol::can_snapshot |
           protocol::can_observe_liquid | protocol::can_measure | protocol::can_linearise |
           protocol::can_respond;
  }

 private:
  // What the solver keeps from window to window besides the engine's state: a rollback restores it, and a
  // restart file holds it. Numbers only, without gaps.
  struct Memory {
    std::int64_t now = 0;  // [ns]
    std::uint64_t micro_steps = 0, particle_steps = 0;
    double density_error = 0;  // largest |rho/rho0 - 1| [-]
    double volume_error = 0;   // largest |V/V0 - 1| of the whole liquid, V0 without pressure [-]
    double speed = 0;          // largest of a particle [m/s]
    // Largest shares of the mass beyond the limits of equations/limits.hpp at one time, and the largest root
    // of the mean square of its Mach number and of its |rho/rho0 - 1| while it was too much mass [-].
    double fast_share = 0, fast_mach = 0, dense_share = 0, dense_compression = 0;
    double wall_speed = 0;     // bound of that of walls [m/s]
    double shortest_step = 0;  // [s]; 0: none was taken
    double energy_start = 0;   // kinetic and of compression [J]
    double energy_scale = 0;   // largest sum of energy and of the sizes of its changes [J]
    double energy_residual = 0;
    double energy_came = 0, energy_went = 0;  // with particles through inlets and outlets [J]
    std::uint64_t lost = 0;                   // particles that left the domain
    double energy_lost = 0;                   // with them [J]

    bool is_possible() const;
  };

  // More than any sound window has.
  static constexpr double most_steps = 1e7;
  // Below this share of the step of the liquid at rest its particles fly apart.
  static constexpr double least_step_share = 0.01;

  double step_at_rest() const;                  // [s]
  std::uint64_t steps_of(double window) const;  // of the liquid at rest
  // Bound of the share of its momentum that a body passes to the liquid in a window [-].
  double most_passed(const LiquidStart& start, double window) const;
  void measure_responses(const LiquidStart& start, const LiquidState& liquid);
  // The next step that the present state allows, of `left` seconds of a window [s].
  double next_step(double left) const;
  void start_moving();
  // Velocity of the vessel at a part `at` of the window [m/s].
  Vec3d frame_velocity(double at) const;
  void set_paths(const protocol::MotionSet& motion);
  void watch_walls();
  void stop_fast_walls(double time) const;
  std::string sentence_of_walls() const;
  void take_step(double dt, double next);
  Error explained(const Error& error) const;
  double mach() const { return memory_.speed / properties_.sound_speed; }
  void add_step(double begin, double dt, double length);
  void record(const Traffic::Brought& brought);
  void record_lost(double time);
  std::string sentence_of_lost() const;
  std::string sentence_of_density() const;
  std::string sentence_of_mach() const;
  double mass() const { return static_cast<double>(id_.size()) * properties_.mass(); }  // [kg]
  std::size_t check_memory(const LiquidStart& start) const;
  void watch_limits();
  void watch_energy();
  void fill(const LiquidState& state, const std::vector<std::uint32_t>& id, Nanoseconds time,
            protocol::ParticlesFrame& frame) const;
  void warn(const std::string& sentence);
  std::vector<std::string> warnings_of_run() const;
  std::string precision_name() const;

  scene::Scene scene_;
  Liquid properties_;
  std::optional<Vessel> vessel_;
  std::optional<std::uint32_t> follows_;  // see LiquidSetup
  Vec3d follows_from_;                    // [m]
  std::unique_ptr<LiquidEngine> engine_;
  // Of each mesh of walls, see walls_of_bodies(), and of each piston of an inlet: its body, and the place of
  // that in the loads.
  std::vector<particles::BoundaryBody> bodies_;
  std::vector<std::size_t> load_of_;
  std::size_t bodies_loaded_ = 0;
  std::vector<std::vector<Vec3d>> corners_;  // of the walls of each of bodies_, in its frame [m]
  Sensors sensors_;
  std::vector<particles::FlowRecord> flows_, saved_flows_;
  Traffic traffic_;
  std::vector<Traffic::Counts> passed_, saved_passed_;
  std::vector<std::uint32_t> id_, saved_id_;  // of the particles, ascending
  std::uint32_t at_start_ = 0;                // particles
  Memory memory_, saved_;
  std::uint64_t least_steps_ = 1;  // in a window
  double longest_step_ = 0;        // for that [s]
  protocol::TangentSet tangents_;
  std::vector<protocol::BodyResponse> responses_;  // in the poses of the start
  std::vector<particles::PreparedPath> paths_;
  std::vector<particles::BodyPose> start_poses_;             // of bodies_
  std::vector<particles::BodyPose> poses_, previous_poses_;  // of bodies_, at the ends of the present step
  double solver_seconds_ = 0, solver_cpu_seconds_ = 0;       // in advance [s]
  bool warned_density_ = false, warned_mach_ = false, warned_walls_ = false, warned_lost_ = false;
  std::vector<std::string> warnings_;
  protocol::LoadSet loads_;
  LiquidState kept_;  // of the snapshot
  std::vector<std::uint32_t> kept_id_;
  protocol::ParticlesFrame frame_, snapshot_;
};

}  // namespace tandem::sph
