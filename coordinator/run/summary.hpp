// summary.json: the machine-readable result of a run, written when the run begins, while it is in progress,
// and at its end of any kind. Keys are only ever added. docs/verdict.md lists the values of `status`.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/error.hpp"
#include "common/scene/element_columns.hpp"
#include "coordinator/results/checks.hpp"
#include "coordinator/results/signals.hpp"
#include "coordinator/run/stopwatch.hpp"
#include "coordinator/scene/options.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "coordinator/start/participants.hpp"
#include "coordinator/start/server_command.hpp"
#include "coordinator/verdict/status.hpp"
#include "coordinator/verdict/verdict.hpp"
#include "coordinator/verdict/wall_watch.hpp"
#include "coordinator/watch/particle_watch.hpp"
#include "coordinator/watch/sphere_watch.hpp"
#include "coordinator/watch/wall_load_watch.hpp"
#include "coordinator/window/coupler.hpp"
#include "protocol/facts.hpp"

namespace tandem::launch {

// The table of docs/results.md.
std::string coordinator_keys_as_markdown();

class Summary {
 public:
  // For a run that begins: its status is `running`. `scene` must outlive this object.
  Summary(const SceneFile& scene, const RunOptions& options);

  // The program that takes a role, and the command that started it where it is not ours.
  void set_server(protocol::Role role, const protocol::Hello& hello,
                  const std::optional<ServerCommand>& foreign);
  // Adds the facts that a solver sent. Lists (left_out, warnings) of the solvers are joined; solver_seconds,
  // which several send, is stored with the solver's name, "mbd_..." and "dem_..."; all other facts of the
  // solver of a liquid are in the object "sph". Throws the ProtocolError of decode_facts(), and
  // Error{protocol} for a key that belongs to the coordinator, such as `status`.
  void add_facts(protocol::Role role, const std::string& facts);
  void add_warning(const std::string& sentence);  // repeated sentences are added once
  // The run continues from this checkpoint.
  void set_restart(const std::filesystem::path& checkpoint, const Coupler& coupler);
  void set_course(const Coupler& coupler, Nanoseconds now, double wall, const TimeSplit& split);
  // Largest and mean values of the columns of elements.csv or sensors.csv, under `list`: "elements" or
  // "sensors".
  void set_columns(const char* list, const Signals& rows);
  void set_checks(const std::vector<CheckResult>& checks);
  void set_particles(const ParticleWatch& watch, const SphereWatch* spheres);
  void set_wall_loads(const WallLoadWatch& watch);
  void set_walls(const WallWatch& watch);
  // Programs that did not end well after their reports.
  void set_leaving(const std::vector<Participants::Leaving>& complaints);

  // What the coordinator itself writes into the object "sph", beside the facts of the solver.
  static constexpr std::array<std::string_view, 4> own_keys_of_liquid{
      "micro_steps", "largest_micro_step_s", "momentum_balance", "momentum_balance_windows"};

  // Sets the final status from the figures. At the end of the scene: `ok` or `suspect` by the verdict,
  // `failed` if a check failed. With `strict` a suspect run has exit status 1.
  void complete(bool checks_passed, bool strict);
  void interrupt();
  // After complete(): the run with half the steps was interrupted. This run keeps its status, and the exit
  // status says that the estimate is missing.
  void interrupt_estimate();
  void fail(const Error& error);

  // What the solvers have reported so far.
  const protocol::SolverFacts& facts() const { return facts_; }
  // "not reported by liggghts 3.8"
  std::string not_reported(protocol::Role role) const;
  const nlohmann::ordered_json& json() const { return json_; }
  Status status() const { return status_; }
  int exit_status() const { return exit_status_; }
  const Verdict& verdict() const { return verdict_; }

  // Replaces the file as a whole: a concurrent reader finds the previous version. Waits for the disk.
  // Throws Error{resource} when the disk is full.
  void write(const std::filesystem::path& file) const;
  // The table printed at the end of a run.
  std::string table() const;

 private:
  // A COORDINATOR_KEY of common/scene/figures.def, to write.
  nlohmann::ordered_json& own(const char* key);
  double number(const char* key) const;  // that was set here, 0 where there is none
  void declare_columns(const scene::Scene& scene);
  void set_time_split(const TimeSplit& split);
  void set_liquid(const ParticleBalance& balance);
  void set_interface(const Coupler& coupler);
  void set_contradictions(const MotionWatch& watch);
  void set_path_differences(const PathWatch& watch);
  void set_machine(const JointWatch& joints, const EnergyWatch& energy);
  void judge();
  void add_rules_without_figures();
  void end(Status status, const char* reason, int exit_status);

  const scene::Scene& scene_;
  nlohmann::ordered_json json_;
  protocol::SolverFacts facts_;
  std::vector<std::string> bodies_;      // names
  std::uint64_t steps_before_ = 0;       // micro steps of the run from which this one continues
  std::vector<std::string> not_judged_;  // about walls
  Verdict verdict_;
  Status status_ = Status::running;
  int exit_status_ = 70;
};

}  // namespace tandem::launch
