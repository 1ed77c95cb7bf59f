// What the solver watches during a run, and reports at its end.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/error.hpp"
#include "common/log.hpp"
#include "particles/serving/state_digest.hpp"
#include "protocol/facts.hpp"
#include "sph_server/coupling/load_solver.hpp"
#include "sph_server/coupling/wall_speed.hpp"
#include "sph_server/equations/limits.hpp"

namespace tandem::sph {

Vec3d Solver::frame_velocity(double at) const {
  return vessel_ ? vessel_->velocity(pose_on_path(paths_[vessel_->wall], at)) : Vec3d{};
}

void Solver::watch_walls() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (bodies_[b].body == ground && !vessel_) continue;
    for (const double at : {0.0, 1.0}) {
      const particles::BodyPose pose = pose_on_path(paths_[b], at);
      const Vec3d frame = frame_velocity(at);
      const double bound = norm(pose.v - frame) + bodies_[b].extent * norm(pose.w);
      if (bound > std::max(memory_.wall_speed, largest_mach * properties_.sound_speed))
        memory_.wall_speed = std::max(memory_.wall_speed, largest_wall_speed(pose, corners_[b], frame));
    }
  }
  if (memory_.wall_speed > largest_mach * properties_.sound_speed && !std::exchange(warned_walls_, true))
    log::warn("{}", sentence_of_walls());
}

// Of bodies with liquid on them, as the last window left them: a coupling that is unstable makes them fast.
void Solver::stop_fast_walls(double time) const {
  const double limit = largest_mach * properties_.sound_speed;
  const std::vector<Wrench> loads = engine_->loads();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (bodies_[b].body == ground || norm2(loads[b].force) == 0) continue;
    const double speed = largest_wall_speed(engine_->poses()[b], corners_[b], frame_velocity(0));
    if (!(speed > limit)) continue;
    throw Error(
        ErrorCode::numerics,
        fmt::format(
            "at t = {:.6g} s a wall of body '{}', which is in the liquid, has {:.3g} m/s, {:.2g} of the "
            "speed of sound (limit {:.2g})",
            time, bodies_[b].name, speed, speed / properties_.sound_speed, largest_mach),
        "liquid",
        fmt::format("where it is meant to be so fast, give an expected_speed of {:.3g} m/s; where its "
                    "velocity alternates, it is light for its liquid: use coupling.scheme = \"implicit\"",
                    speed));
  }
}

std::string Solver::sentence_of_walls() const {
  return fmt::format(
      "a wall of the liquid has up to {:.3g} m/s, {:.2g} of the speed of sound (limit {:.2g}): where the "
      "liquid is beside it, use an expected_speed of {:.3g} m/s",
      memory_.wall_speed, memory_.wall_speed / properties_.sound_speed, largest_mach, memory_.wall_speed);
}

std::string Solver::sentence_of_lost() const {
  return fmt::format(
      "{} particles of the liquid, {:.3g} kg, have left the domain and were taken out: enlarge sph.domain, "
      "or "
      "use sph.outlets where they are meant to leave",
      memory_.lost, static_cast<double>(memory_.lost) * properties_.mass());
}

// Where the liquid was far too fast or too dense before, the error says so.
Error Solver::explained(const Error& error) const {
  if (error.code() != ErrorCode::numerics) return error;
  if (memory_.density_error > largest_density_error || mach() > largest_flow_mach)
    return Error(
        error.code(),
        fmt::format("{}; before, the density of the liquid was off by {:.2g} (limit {:.2g}), and "
                    "its fastest particle had {:.2g} of the speed of sound (limit {:.2g})",
                    error.problem(), memory_.density_error, largest_density_error, mach(), largest_flow_mach),
        error.where(),
        fmt::format("use a larger sound_speed (now {:.3g} m/s): ten times the largest speed that "
                    "liquid and walls will have",
                    properties_.sound_speed));
  if (const std::uint64_t passed = engine_->figures().passed_walls; passed > 0)
    return Error(error.code(),
                 fmt::format("{}; before, {} times a particle passed a wall", error.problem(), passed),
                 error.where(), "use a smaller sph.spacing, or a larger sound_speed");
  return error;
}

std::string Solver::sentence_of_density() const {
  return fmt::format(
      "the density of up to {:.2g} of the mass of the liquid was off by more than {:.2g}, by up to {:.2g} in "
      "the "
      "mean: use a sound_speed of {:.3g} m/s (now {:.3g})",
      memory_.dense_share, largest_density_error, memory_.dense_compression,
      sound_factor_for_density(memory_.dense_compression) * properties_.sound_speed, properties_.sound_speed);
}

std::string Solver::sentence_of_mach() const {
  return fmt::format(
      "up to {:.2g} of the mass of the liquid had more than {:.2g} of the speed of sound, up to {:.2g} in "
      "the "
      "mean: "
      "use a sound_speed of {:.3g} m/s (now {:.3g})",
      memory_.fast_share, largest_flow_mach, memory_.fast_mach,
      sound_factor_for_mach(memory_.fast_mach) * properties_.sound_speed, properties_.sound_speed);
}

void Solver::watch_limits() {
  const StepFigures figures = engine_->figures();
  memory_.density_error = std::max(memory_.density_error, figures.largest_compression);
  memory_.speed = std::max(memory_.speed, figures.largest_speed);
  const auto keep = [](double share, double mean, double limit, double& most, double& mean_beyond) {
    most = std::max(most, share);
    if (share > limit) mean_beyond = std::max(mean_beyond, mean);
  };
  keep(figures.fast_share, figures.fast_mach, largest_fast_share, memory_.fast_share, memory_.fast_mach);
  keep(figures.dense_share, figures.dense_compression, largest_dense_share, memory_.dense_share,
       memory_.dense_compression);
  if (memory_.dense_share > largest_dense_share && !std::exchange(warned_density_, true))
    log::warn("{}", sentence_of_density());
  if (memory_.fast_share > largest_fast_share && !std::exchange(warned_mach_, true))
    log::warn("{}", sentence_of_mach());
}

void Solver::watch_energy() {
  const EnergyBalance e = engine_->energies();
  const double energy = e.kinetic + e.compression;
  memory_.energy_residual = energy - memory_.energy_start - e.changes() - memory_.energy_came +
                            memory_.energy_went + memory_.energy_lost;
  double scale = energy + memory_.energy_came + memory_.energy_went + memory_.energy_lost;
  for (const double change :
       {e.gravity, e.viscosity, e.bulk_viscosity, e.diffusion, e.cavitation, e.ghost, e.repulsion, e.walls})
    scale += std::abs(change);
  memory_.energy_scale = std::max(memory_.energy_scale, scale);
}

void Solver::warn(const std::string& sentence) {
  log::warn("{}", sentence);
  warnings_.push_back(sentence);
}

std::vector<std::string> Solver::warnings_of_run() const {
  std::vector<std::string> all = warnings_;
  if (memory_.dense_share > largest_dense_share) all.push_back(sentence_of_density());
  if (memory_.fast_share > largest_fast_share) all.push_back(sentence_of_mach());
  if (memory_.wall_speed > largest_mach * properties_.sound_speed) all.push_back(sentence_of_walls());
  if (memory_.lost > 0) all.push_back(sentence_of_lost());
  for (const std::string& sentence : sensors_.warnings(flows_)) all.push_back(sentence);
  if (const std::uint64_t passed = engine_->figures().passed_walls; passed > 0)
    all.push_back(fmt::format("{} times a particle of the liquid passed a wall", passed));
  if (const double left = norm(engine_->figures().pair_impulse_rate); left > 0)
    all.push_back(
        fmt::format("forces between particles should cancel, and leave {:.3g} N: a particle is in the list "
                    "of another one that is not in its own list",
                    left));
  return all;
}

protocol::Report Solver::report() {
  const LiquidState state = engine_->state();
  particles::StateDigest digest;
  for (std::size_t i = 0; i < state.size(); ++i) {
    digest.mix(state.position[i]);
    digest.mix(state.velocity[i]);
    digest.mix(state.compression[i]);
  }
  const StepFigures figures = engine_->figures();
  const EnergyBalance e = engine_->energies();
  protocol::SphFacts facts;
  facts.state_hash = digest.text();
  facts.solver_seconds = solver_seconds_;
  facts.density_error = memory_.density_error;
  facts.mach = mach();
  facts.fast_share = memory_.fast_share;
  facts.fast_mach = memory_.fast_mach;
  facts.dense_share = memory_.dense_share;
  facts.dense_error = memory_.dense_compression;
  facts.volume_error = memory_.volume_error;
  facts.passed_walls = figures.passed_walls;
  facts.energy_residual = memory_.energy_residual;
  facts.energy_scale = memory_.energy_scale;
  const auto mass_of = [&](std::uint64_t particles) {
    return static_cast<double>(particles) * properties_.mass();
  };
  facts.lost = mass_of(memory_.lost);
  facts.mass_in_all = mass_of(at_start_ + traffic_.came_in(passed_));
  facts.warnings = warnings_of_run();
  nlohmann::ordered_json others;
  others["solver_cpu_seconds"] = solver_cpu_seconds_;
  others["max_speed"] = memory_.speed;
  others["shortest_step_s"] = memory_.shortest_step;
  others["lost_particles"] = memory_.lost;
  others["list_rebuilds"] = figures.rebuilds;
  others["particle_steps"] = memory_.particle_steps;
  others["energy_J"] = {{"kinetic", e.kinetic}, {"compression", e.compression}};
  others["work_J"] = {
      {"gravity", e.gravity},     {"viscosity", e.viscosity},   {"bulk_viscosity", e.bulk_viscosity},
      {"diffusion", e.diffusion}, {"cavitation", e.cavitation}, {"ghost", e.ghost},
      {"repulsion", e.repulsion}, {"walls", e.walls},           {"edges", e.edges}};
  if (traffic_.any()) {
    others["work_J"]["inlets"] = memory_.energy_came;
    others["work_J"]["outlets"] = -memory_.energy_went;
  }
  others["work_J"]["lost"] = 0 - memory_.energy_lost;
  traffic_.report(passed_, facts, others);
  return {protocol::encode_facts(facts, others)};
}

}  // namespace tandem::sph
