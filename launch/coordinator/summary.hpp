// summary.json: the machine-readable result of a run, written however the run ended. Keys only get added.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "launch/coordinator/coupler.hpp"
#include "launch/coordinator/options.hpp"
#include "launch/coordinator/scene_file.hpp"
#include "launch/coordinator/stopwatch.hpp"
#include "launch/results/checks.hpp"

namespace tandem::launch {

enum class Status { ok, checks_failed, interrupted, failed };
const char* name(Status status);

class Summary {
 public:
  Summary(const SceneFile& scene, const RunOptions& options);

  // Facts that a solver sent: a JSON object. Lists (left_out, warnings) of the two solvers are joined; a
  // number or text that both send is kept under the solver's name, "mbd_..." and "dem_...".
  void add_facts(protocol::Role role, const std::string& facts);
  void add_warning(const std::string& sentence);  // once, however often it is added
  // The run goes on from there.
  void set_restart(const std::filesystem::path& checkpoint, const Coupler& coupler);
  void set_course(const Coupler& coupler, Nanoseconds now, double wall, const TimeSplit& split);
  void set_checks(const std::vector<CheckResult>& checks);
  void set_end(Status status, const Error* error = nullptr);

  // A fact of a solver, 0 where there is none.
  double number(const std::string& key) const;
  const nlohmann::ordered_json& json() const { return json_; }
  Status status() const { return status_; }
  int exit_status() const { return exit_status_; }

  // Error{resource} when the disk is full.
  void write(const std::filesystem::path& file) const;
  // What a person wants to see at the end of a run.
  std::string table() const;

 private:
  void set_border(const Coupler& coupler);

  nlohmann::ordered_json json_;
  std::vector<std::string> bodies_;  // names
  std::uint64_t steps_before_ = 0;   // micro steps of the run that this one goes on from
  Status status_ = Status::failed;
  int exit_status_ = 70;
};

}  // namespace tandem::launch
