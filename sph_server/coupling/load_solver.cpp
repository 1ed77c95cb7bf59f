#include "sph_server/coupling/load_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/log.hpp"
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
  for (const double figure :
       {density_error, volume_error, speed, fast_share, fast_mach, dense_share, dense_compression, wall_speed,
        shortest_step, energy_scale, energy_came, energy_went, energy_lost})
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
  const double longest = std::min({stable, scene_.sph->micro_step.value_or(stable), longest_step_});
  return left / std::max(1.0, std::ceil(left / longest * (1 - 1e-12)));
}

void Solver::set_paths(const protocol::MotionSet& motion) {
  paths_.clear();
  for (const particles::BoundaryBody& body : bodies_)
    paths_.push_back(
        particles::prepare_path(segment_of(body, motion), motion.window.length(), body.name.c_str()));
}

// At the start only the multibody solver knows the velocities that joints give to bodies: the first step has
// those of the first motion, and a liquid without a velocity of its own has that of its vessel.
void Solver::start_moving() {
  std::vector<particles::BodyPose> poses = engine_->poses();
  bool same = true;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (bodies_[b].body == ground) continue;
    const particles::BodyPose begin = pose_on_path(paths_[b], 0);
    same = same && begin.v == poses[b].v && begin.w == poses[b].w;
    poses[b].v = begin.v;
    poses[b].w = begin.w;
  }
  if (same) return;
  LiquidState state = engine_->state();
  if (vessel_ && !scene_.sph->liquids.front().velocity)
    state.velocity.assign(state.size(), vessel_->velocity(poses[vessel_->wall]));
  if (state.size() > 0) engine_->set_state(state, poses);
  const EnergyBalance energies = engine_->energies();
  memory_.energy_start = energies.kinetic + energies.compression;
  memory_.energy_scale = memory_.energy_start;
}

void Solver::take_step(double dt, double next) {
  try {
    engine_->step(dt, poses_, next);
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
  longest_step_ = length / static_cast<double>(least_steps_);
  set_paths(motion);
  if (memory_.micro_steps == 0) start_moving();
  stop_fast_walls(to_seconds(motion.window.begin));
  watch_walls();
  loads_.window = motion.window;
  loads_.bodies.assign(bodies_loaded_, {});
  for (std::size_t b = 0; b < bodies_.size(); ++b) loads_.bodies[load_of_[b]].body = bodies_[b].body.value;
  sensors_.begin_window();
  protocol::ParticleAccount& account = loads_.account;
  account.momentum_begin = engine_->momentum();
  account.lost_momentum = {};
  const std::size_t at_begin = id_.size();
  const Vec3d domain_shift = follows_ ? engine_->poses()[*follows_].p - follows_from_ : Vec3d{};
  record(traffic_.drain(*engine_, domain_shift, id_, passed_));
  record_lost(to_seconds(motion.window.begin));
  previous_poses_ = engine_->poses();
  std::uint64_t steps = 0;
  double fallen = 0;  // integral of the mass of the liquid [kg s]
  const double start = to_seconds(motion.window.begin), nearly = 0.5 * step_at_rest();
  for (double t = 0; t < length; ++steps) {
    // A layer comes in up to half a step early or late, so that no step is much shorter than the others.
    if (traffic_.next(passed_) <= start + t + nearly) {
      record(traffic_.feed(*engine_, start + t, start + t + nearly, at_start_, id_, passed_));
      record_lost(start + t);
      previous_poses_ = engine_->poses();
    }
    const double due = traffic_.next(passed_) - start, stop = due < length - nearly ? due : length;
    const double dt = next_step(stop - t);
    const double end = stop - t - dt < 0.5 * dt ? stop : t + dt;
    poses_.clear();
    for (const particles::PreparedPath& path : paths_) poses_.push_back(pose_on_path(path, end / length));
    traffic_.place_pistons(start + end, passed_, poses_);
    take_step(end - t, end < stop ? dt : 0);
    add_step(t, end - t, length);
    fallen += (end - t) * mass();
    record_lost(start + end);
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
  const bool same = !traffic_.any() && id_.size() == at_begin;
  account.gravity_impulse = (same ? length * mass() : fallen) * properties_.gravity;
  account.lost_particles = memory_.lost;
  account.rebuilds = engine_->figures().rebuilds;
  memory_.now = motion.window.end.count;
  memory_.micro_steps += steps;
  watch_energy();
  if (const double volume = mass() / properties_.density; volume > 0)
    memory_.volume_error = std::max(memory_.volume_error, std::abs(engine_->volume() / volume - 1));
  account.kinetic_energy = engine_->energies().kinetic;
  if (sensors_.any()) loads_.sensors = sensors_.measure(*engine_, length, flows_);
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

// Particles that have left the domain by `time` [s].
void Solver::record_lost(double time) {
  const LostParticles lost = engine_->take_lost();
  if (lost.index.empty()) return;
  auto next = lost.index.begin();
  std::size_t kept = 0;
  for (std::uint32_t i = 0; i < id_.size(); ++i)
    if (next != lost.index.end() && *next == i)
      ++next;
    else
      id_[kept++] = id_[i];
  id_.resize(kept);
  loads_.account.lost_momentum += lost.momentum;
  memory_.energy_lost += lost.energy;
  memory_.lost += lost.index.size();
  if (!std::exchange(warned_lost_, true)) log::warn("{} by t = {:.6g} s", sentence_of_lost(), time);
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
  saved_flows_ = flows_;
  saved_passed_ = passed_;
  saved_id_ = id_;
}

void Solver::restore() {
  engine_->restore();
  memory_ = saved_;
  flows_ = saved_flows_;
  passed_ = saved_passed_;
  id_ = saved_id_;
}

std::string Solver::precision_name() const {
  return scene_.sph->precision == scene::LiquidPrecision::mixed ? "mixed" : "double";
}

}  // namespace tandem::sph
