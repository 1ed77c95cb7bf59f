#include "sph_server/coupling/load_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/log.hpp"
#include "particles/serving/state_digest.hpp"
#include "protocol/facts.hpp"
#include "sph_server/coupling/make_solver.hpp"
#include "sph_server/equations/limits.hpp"
#include "sph_server/equations/time_step.hpp"

namespace tandem::sph {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

std::unique_ptr<protocol::LoadSolver> make_solver() {
  return std::make_unique<Solver>();
}

bool Solver::Memory::is_possible() const {
  for (const double figure : {density_error, volume_error, speed, wall_speed, shortest_step, energy_scale,
                              energy_came, energy_went})
    if (!(std::isfinite(figure) && figure >= 0)) return false;
  return std::isfinite(energy_start) && std::isfinite(energy_residual);
}

double Solver::step_at_rest() const {
  const double stable = step_limits(properties_, 0, norm(properties_.gravity)).smallest;
  return std::min(stable, scene_.sph->micro_step.value_or(stable));
}

double Solver::next_step(double left) const {
  const StepFigures figures = engine_->figures();
  const double stable =
      step_limits(properties_, figures.largest_speed, figures.largest_acceleration).smallest;
  if (!(stable >= least_step_share * step_at_rest()))
    throw Error(
        ErrorCode::numerics,
        fmt::format("the liquid flies apart: with a particle of {:.3g} m/s and one of {:.3g} m/s2 the "
                    "step would be {:.3g} s, and that of the liquid at rest is {:.3g} s",
                    figures.largest_speed, figures.largest_acceleration, stable, step_at_rest()),
        "liquid",
        "give a larger sound_speed or artificial_viscosity, or a smaller sph.spacing where bodies or "
        "walls are only a few spacings thick");
  const double longest = std::min(stable, scene_.sph->micro_step.value_or(stable));
  return left / std::max(1.0, std::ceil(left / longest * (1 - 1e-12)));
}

void Solver::set_paths(const protocol::MotionSet& motion) {
  paths_.clear();
  for (const particles::BoundaryBody& body : bodies_)
    paths_.push_back(
        particles::prepare_path(segment_of(body, motion), motion.window.length(), body.name.c_str()));
}

void Solver::watch_walls() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (bodies_[b].body == ground) continue;
    for (const double at : {0.0, 1.0}) {
      const particles::BodyPose pose = pose_on_path(paths_[b], at);
      memory_.wall_speed = std::max(memory_.wall_speed, norm(pose.v) + bodies_[b].extent * norm(pose.w));
    }
  }
  if (memory_.wall_speed > largest_mach * properties_.sound_speed && !std::exchange(warned_walls_, true))
    log::warn("{}", sentence_of_walls());
}

std::string Solver::sentence_of_walls() const {
  return fmt::format(
      "a wall of the liquid has up to {:.3g} m/s, {:.2g} of the speed of sound (limit {:.2g}): where the "
      "liquid is beside it, use an expected_speed of {:.3g} m/s",
      memory_.wall_speed, memory_.wall_speed / properties_.sound_speed, largest_mach, memory_.wall_speed);
}

// A liquid that is far too fast or too dense goes anywhere at last: the error then says so first.
Error Solver::explained(const Error& error) const {
  if (error.code() != ErrorCode::numerics) return error;
  if (memory_.density_error > largest_density_error || mach() > largest_mach)
    return Error(
        error.code(),
        fmt::format("{}; before, the density of the liquid was off by {:.2g} (limit {:.2g}), and "
                    "its fastest particle had {:.2g} of the speed of sound (limit {:.2g})",
                    error.problem(), memory_.density_error, largest_density_error, mach(), largest_mach),
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

void Solver::take_step(double dt) {
  try {
    engine_->step(dt, poses_);
  } catch (const Error& error) {
    throw explained(error);
  }
}

const protocol::LoadSet& Solver::advance(const protocol::MotionSet& motion) {
  const Clock::time_point begin = Clock::now();
  const double cpu_begin = cpu_seconds(CpuClock::process);  // of all threads
  const double length = motion.window.length();
  if (const double steps = length / step_at_rest(); !(steps <= most_steps))
    throw Error(
        ErrorCode::protocol,
        fmt::format("a window of {:.4g} s would have {:.4g} steps of {:.4g} s; at most {:.0f} are done",
                    length, steps, step_at_rest(), most_steps),
        "motion", "send windows no longer than those of the scene");
  set_paths(motion);
  watch_walls();
  loads_.window = motion.window;
  loads_.bodies.assign(bodies_loaded_, {});
  for (std::size_t b = 0; b < bodies_.size(); ++b) loads_.bodies[load_of_[b]].body = bodies_[b].body.value;
  sensors_.begin_window();
  protocol::ParticleAccount& account = loads_.account;
  account.momentum_begin = engine_->momentum();
  account.lost_momentum = {};
  record(traffic_.drain(*engine_, id_, passed_));
  previous_poses_ = engine_->poses();
  std::uint64_t steps = 0;
  double fallen = 0;  // integral of the mass of the liquid [kg s]
  const double start = to_seconds(motion.window.begin), nearly = 0.5 * step_at_rest();
  for (double t = 0; t < length; ++steps) {
    // A layer comes in up to half a step early or late, so that no step is much shorter than the others.
    if (traffic_.next(passed_) <= start + t + nearly) {
      record(traffic_.feed(*engine_, start + t, start + t + nearly, at_start_, id_, passed_));
      previous_poses_ = engine_->poses();
    }
    const double due = traffic_.next(passed_) - start, stop = due < length - nearly ? due : length;
    const double dt = next_step(stop - t);
    const double end = stop - t - dt < 0.5 * dt ? stop : t + dt;
    poses_.clear();
    for (const particles::PreparedPath& path : paths_) poses_.push_back(pose_on_path(path, end / length));
    traffic_.place_pistons(start + end, passed_, poses_);
    take_step(end - t);
    add_step(t, end - t, length);
    fallen += (end - t) * mass();
    memory_.particle_steps += id_.size();
    watch_limits();
    std::swap(poses_, previous_poses_);
    t = end;
  }
  const std::vector<Wrench> at_end = engine_->loads();
  for (protocol::BodyLoad& load : loads_.bodies)
    for (Wrench* sum : {&load.mean, &load.first_moment}) {
      sum->force *= 1 / length;
      sum->torque *= 1 / length;
    }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Wrench& end = loads_.bodies[load_of_[b]].end;
    end.force += at_end[b].force;
    end.torque += at_end[b].torque;
    if (bodies_[b].body == ground) end.torque += cross(engine_->poses()[b].p, at_end[b].force);
  }
  account.micro_steps = steps;
  account.micro_step = length / static_cast<double>(steps);
  account.momentum_end = engine_->momentum();
  account.gravity_impulse = (traffic_.any() ? fallen : length * mass()) * properties_.gravity;
  account.rebuilds = engine_->figures().rebuilds;
  memory_.now = motion.window.end.count;
  memory_.micro_steps += steps;
  watch_energy();
  if (const double volume = mass() / properties_.density; volume > 0)
    memory_.volume_error = std::max(memory_.volume_error, std::abs(engine_->volume() / volume - 1));
  account.kinetic_energy = engine_->energies().kinetic;
  if (sensors_.any()) loads_.sensors = sensors_.measure(engine_->state(), engine_->poses(), length, seen_);
  solver_cpu_seconds_ += cpu_seconds(CpuClock::process) - cpu_begin;
  solver_seconds_ += std::chrono::duration<double>(Clock::now() - begin).count();
  return loads_;
}

// Adds the impulse of a step from `begin` [s] on to the sums of a window.
void Solver::add_step(double begin, double dt, double length) {
  const std::vector<Wrench>& loads = engine_->step_loads();
  const double from_middle = begin + 0.5 * dt - 0.5 * length;
  sensors_.add_step(dt, loads, previous_poses_);
  memory_.shortest_step = memory_.shortest_step > 0 ? std::min(memory_.shortest_step, dt) : dt;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    protocol::BodyLoad& sum = loads_.bodies[load_of_[b]];
    const Vec3d impulse = dt * loads[b].force;
    Vec3d twist = dt * loads[b].torque;
    // The torque of the ground is about the world's origin; pistons have their own.
    if (bodies_[b].body == ground) twist += cross(previous_poses_[b].p, impulse);
    sum.mean.force += impulse;
    sum.mean.torque += twist;
    sum.first_moment.force += from_middle * impulse;
    sum.first_moment.torque += from_middle * twist;
    if (bodies_[b].body == ground) continue;
    const particles::BodyPose &from = previous_poses_[b], &to = poses_[b];
    sum.work += dot(impulse, 0.5 * (from.v + to.v)) + dot(twist, 0.5 * (from.w + to.w));
  }
}

void Solver::record(const Traffic::Brought& brought) {
  loads_.account.lost_momentum -= brought.momentum;
  memory_.energy_came += brought.came;
  memory_.energy_went += brought.went;
}

void Solver::watch_limits() {
  const StepFigures figures = engine_->figures();
  memory_.density_error = std::max(memory_.density_error, figures.largest_compression);
  memory_.speed = std::max(memory_.speed, figures.largest_speed);
  if (memory_.density_error > largest_density_error && !std::exchange(warned_density_, true))
    log::warn("the density of a particle is off by {:.2g}, beyond {:.2g}: use a sound_speed of {:.3g} m/s",
              memory_.density_error, largest_density_error,
              sound_factor_for_density(memory_.density_error) * properties_.sound_speed);
  if (mach() > largest_mach && !std::exchange(warned_mach_, true))
    log::warn(
        "a particle has {:.3g} m/s, {:.2g} of the speed of sound (limit {:.2g}): use a sound_speed of {:.3g} "
        "m/s",
        memory_.speed, mach(), largest_mach, sound_factor_for_mach(mach()) * properties_.sound_speed);
}

void Solver::watch_energy() {
  const EnergyBalance e = engine_->energies();
  const double energy = e.kinetic + e.compression;
  memory_.energy_residual =
      energy - memory_.energy_start - e.changes() - memory_.energy_came + memory_.energy_went;
  double scale = energy + memory_.energy_came + memory_.energy_went;
  for (const double change :
       {e.gravity, e.viscosity, e.bulk_viscosity, e.diffusion, e.cavitation, e.ghost, e.repulsion, e.walls})
    scale += std::abs(change);
  memory_.energy_scale = std::max(memory_.energy_scale, scale);
}

void Solver::fill(const LiquidState& state, const std::vector<std::uint32_t>& id, Nanoseconds time,
                  protocol::ParticlesFrame& frame) const {
  const std::size_t n = state.size();
  frame.time = time;
  frame.id = id;
  frame.position.resize(3 * n);
  frame.velocity.resize(3 * n);
  frame.spin.assign(3 * n, 0.0f);
  frame.radius.assign(n, static_cast<float>(0.5 * properties_.spacing));
  frame.liquid.resize(protocol::ParticlesFrame::liquid_values * n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      frame.position[3 * i + a] = state.position[i][static_cast<int>(a)];
      frame.velocity[3 * i + a] = static_cast<float>(state.velocity[i][static_cast<int>(a)]);
    }
    frame.liquid[2 * i] = static_cast<float>(state.pressure[i]);
    frame.liquid[2 * i + 1] = static_cast<float>(properties_.density * (1 + state.compression[i]));
  }
}

const protocol::ParticlesFrame& Solver::observe() {
  fill(engine_->state(), id_, Nanoseconds{memory_.now}, frame_);
  return frame_;
}

void Solver::snapshot() {
  kept_ = engine_->state();
  kept_id_ = id_;
  snapshot_.time = Nanoseconds{memory_.now};
}

const protocol::ParticlesFrame& Solver::read_snapshot() {
  fill(kept_, kept_id_, snapshot_.time, snapshot_);
  return snapshot_;
}

void Solver::save() {
  engine_->save();
  saved_ = memory_;
  saved_seen_ = seen_;
  saved_passed_ = passed_;
  saved_id_ = id_;
}

void Solver::restore() {
  engine_->restore();
  memory_ = saved_;
  seen_ = saved_seen_;
  passed_ = saved_passed_;
  id_ = saved_id_;
}

void Solver::warn(const std::string& sentence) {
  log::warn("{}", sentence);
  warnings_.push_back(sentence);
}

std::string Solver::precision_name() const {
  return scene_.sph->precision == scene::LiquidPrecision::mixed ? "mixed" : "double";
}

std::vector<std::string> Solver::warnings_of_run() const {
  std::vector<std::string> all = warnings_;
  if (memory_.density_error > largest_density_error)
    all.push_back(fmt::format(
        "the density of the liquid was off by up to {:.2g} (limit {:.2g}): use a sound_speed of {:.3g} m/s "
        "(now {:.3g})",
        memory_.density_error, largest_density_error,
        sound_factor_for_density(memory_.density_error) * properties_.sound_speed, properties_.sound_speed));
  if (mach() > largest_mach)
    all.push_back(fmt::format(
        "the fastest particle of the liquid had {:.3g} m/s, {:.2g} of the speed of sound (limit {:.2g}): use "
        "a sound_speed of {:.3g} m/s (now {:.3g})",
        memory_.speed, mach(), largest_mach, sound_factor_for_mach(mach()) * properties_.sound_speed,
        properties_.sound_speed));
  if (memory_.wall_speed > largest_mach * properties_.sound_speed) all.push_back(sentence_of_walls());
  for (const std::string& sentence : sensors_.warnings(seen_)) all.push_back(sentence);
  if (const std::uint64_t passed = engine_->figures().passed_walls; passed > 0)
    all.push_back(fmt::format("{} times a particle of the liquid passed a wall", passed));
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
  facts.volume_error = memory_.volume_error;
  facts.passed_walls = figures.passed_walls;
  facts.energy_residual = memory_.energy_residual;
  facts.energy_scale = memory_.energy_scale;
  facts.warnings = warnings_of_run();
  nlohmann::ordered_json others;
  others["solver_cpu_seconds"] = solver_cpu_seconds_;
  others["max_speed"] = memory_.speed;
  others["shortest_step_s"] = memory_.shortest_step;
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
  traffic_.report(passed_, facts, others);
  return {protocol::encode_facts(facts, others)};
}

}  // namespace tandem::sph
