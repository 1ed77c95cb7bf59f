#include "dem_server/coupling/load_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/log.hpp"
#include "dem_server/contact/dissipation.hpp"
#include "dem_server/coupling/history.hpp"
#include "dem_server/coupling/make_solver.hpp"
#include "dem_server/coupling/state_hash.hpp"
#include "dem_server/coupling/tangents.hpp"

namespace tandem::dem {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Bound of |f'| over a cubic Hermite that moves by `mean` with the end rates `begin` and `end`: the
// derivative is mean + b(s) (begin - mean) + e(s) (end - mean) with |b|, |e| <= 1.
double rate_bound(Vec3d mean, Vec3d begin, Vec3d end) {
  return norm(mean) + norm(begin - mean) + norm(end - mean);
}

void add(const Wrench& load, Wrench& sum) {
  sum.force += load.force;
  sum.torque += load.torque;
}

// Adds the load on a belt to that on its body.
void add(const protocol::BodyLoad& load, protocol::BodyLoad& sum) {
  add(load.mean, sum.mean);
  add(load.first_moment, sum.first_moment);
  add(load.end, sum.end);
  sum.work += load.work;
}

}  // namespace

std::unique_ptr<protocol::LoadSolver> make_solver() {
  return std::make_unique<Solver>();
}

std::unique_ptr<protocol::LoadSolver> make_solver_of_rank(particles::Ranks& ranks) {
  return std::make_unique<Solver>(&ranks);
}

double Solver::steps_in(double length) const {
  return std::ceil(length / largest_step_ * (1 - 1e-12));
}

double Solver::longest_window() const {
  return scene_.coupling.adaptive ? scene_.coupling.adaptive->max_window : scene_.coupling.window;
}

const protocol::LoadSet& Solver::advance(const protocol::MotionSet& motion) {
  const Clock::time_point begin = Clock::now();
  const double cpu_begin = cpu_seconds(CpuClock::process);  // of all threads
  const double length = motion.window.length();
  const double steps = steps_in(length);
  if (!(steps >= 1 && steps <= most_steps))
    throw Error(ErrorCode::protocol,
                fmt::format("a window of {:.4g} s would have {:.4g} micro steps of {:.4g} s; at most {:.0f} "
                            "are done",
                            length, steps, largest_step_, most_steps),
                "motion", "send windows no longer than those of the scene");
  plan_.steps = static_cast<std::uint32_t>(steps);
  plan_.dt = length / plan_.steps;
  set_paths(motion);
  if (belts_.any())
    plan_.belt_velocity = belts_.velocities(to_seconds(motion.window.begin), plan_.steps, plan_.dt);
  pass_inlets_and_outlets(motion.window.begin);
  const std::uint32_t regions = engine_->regions();
  const WindowOutcome& outcome = advance_engine();
  if (regions > 0 && engine_->regions() == 0)
    log::info("the spheres no longer fit into shared memory: steps go through memory from now on");
  record_loads(motion.window, outcome);
  if (belts_.any()) belts_.record(outcome, plan_, memory_.belts);
  if (sensors_.any()) {
    poses_.clear();
    for (const PreparedPath& path : paths_) poses_.push_back(pose_on_path(path, 1));
    loads_.sensors = sensors_.measure(*engine_, poses_, length, outcome.wall_means, memory_.sensors);
  }
  memory_.now = motion.window.end;
  memory_.micro_steps += plan_.steps;
  memory_.sphere_steps += std::uint64_t{outcome.window.used} * plan_.steps;
  for (const std::string& sentence : watch_.observe(outcome, plan_, to_seconds(memory_.now), memory_.limits))
    log::warn("{}", sentence);
  solver_cpu_seconds_ += cpu_seconds(CpuClock::process) - cpu_begin;
  solver_seconds_ += seconds_since(begin);
  if (outcome.window.lost > memory_.lost_reported) {
    const std::string sentence = fmt::format(
        "{} spheres have left the domain by t = {:.6g} s and were taken out: use a larger dem.domain, or "
        "dem.outlets where they are meant to leave",
        outcome.window.lost, to_seconds(memory_.now));
    if (memory_.lost_reported == 0) log::warn("{}", sentence);
    memory_.lost_reported = outcome.window.lost;
  }
  return loads_;
}

void Solver::pass_inlets_and_outlets(Nanoseconds now) {
  if (!traffic_.any()) return;
  poses_.clear();
  for (const PreparedPath& path : paths_) poses_.push_back(pose_on_path(path, 0));
  for (const std::string& sentence :
       traffic_.pass(*engine_, now, poses_, plan_.domain_shift, memory_.traffic))
    log::warn("{}", sentence);
}

// Adds the sphere's history, as far as it is known, to an error of one sphere.
const WindowOutcome& Solver::advance_engine() {
  try {
    return engine_->advance(plan_);
  } catch (const SphereError& error) {
    std::vector<BodyPose> poses;
    for (const PreparedPath& path : paths_)
      poses.push_back(pose_on_path(path, static_cast<double>(error.step) / plan_.steps));
    std::string problem = error.problem() + "; " + history(error, surface_, poses, scene_);
    if (const auto last = position_in(frame_, error.id))
      problem += fmt::format("; in the last frame, t = {:.6g} s, it was at ({:.6g}, {:.6g}, {:.6g}) m",
                             to_seconds(frame_.time), last->x, last->y, last->z);
    throw Error(error.code(), problem, error.where(), error.hint());
  }
}

// Bound of the distance from `origin` at which a sphere of the domain may be in contact with a wall [m].
double Solver::farthest_contact(Vec3d origin) const {
  const scene::Box& domain = scene_.dem->domain;
  const Vec3d from = origin - plan_.domain_shift;
  Vec3d away;  // of the farthest corner
  for (int a = 0; a < 3; ++a)
    away[a] = std::max(std::abs(domain.min[a] - from[a]), std::abs(domain.max[a] - from[a]));
  return norm(away) + surface_.reach;
}

void Solver::set_paths(const protocol::MotionSet& motion) {
  const double length = motion.window.length();
  paths_.clear();
  plan_.body_speed = plan_.wall_jump = 0;
  for (const BoundaryBody& boundary : bodies_)
    if (boundary.body != ground && scene_.dem->follows == boundary.body)
      plan_.domain_shift =
          segment_of(boundary, motion).begin.p_WB - scene_.mbd->bodies[boundary.body.value].pose.p_WB;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const BoundaryBody& boundary = bodies_[b];
    LastMotion& last = memory_.bodies[b];
    const PathSegment segment = segment_of(boundary, motion);
    const PreparedPath path = prepare_path(segment, length, boundary.name.c_str());
    const double linear = rate_bound((1 / length) * (segment.end.p_WB - segment.begin.p_WB),
                                     segment.begin_twist.v_WB, segment.end_twist.v_WB);
    const double angular =
        rate_bound((1 / length) * path.rotation_vector, (1 / length) * path.rotation_rate_begin,
                   (1 / length) * path.rotation_rate_end);
    // An infinite wall matters only where spheres can reach it, wherever the body's origin is.
    const double extent = std::min(boundary.extent, farthest_contact(segment.begin.p_WB) + linear * length);
    plan_.body_speed = std::max(plan_.body_speed, linear + angular * extent);
    if (last.known) {
      const double angle = norm(rotation_vector(path.segment.begin.q_WB * last.pose.q_WB.conjugate()));
      const double jump = norm(path.segment.begin.p_WB - last.pose.p_WB) + angle * extent;
      plan_.wall_jump = std::max(plan_.wall_jump, jump);
    }
    last = {path.segment.end, path.segment.end_twist, 1};
    paths_.push_back(path);
  }
  plan_.paths = paths_;
}

void Solver::record_loads(const Window& window, const WindowOutcome& outcome) {
  const WindowProgress& c = outcome.window;
  loads_.window = window;
  loads_.bodies.clear();
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    const protocol::BodyLoad load = load_of(body, window.length(), outcome);
    if (!loads_.bodies.empty() && loads_.bodies.back().body == load.body)
      add(load, loads_.bodies.back());
    else
      loads_.bodies.push_back(load);
  }
  protocol::ParticleAccount& a = loads_.account;
  a.micro_steps = plan_.steps;
  a.micro_step = plan_.dt;
  a.momentum_begin = outcome.begin.momentum;
  a.momentum_end = outcome.end.momentum;
  a.gravity_impulse = outcome.gravity_impulse;
  a.lost_momentum = outcome.lost_momentum;
  a.kinetic_energy = outcome.end.kinetic_energy;
  a.max_overlap_ratio = static_cast<double>(c.max_overlap_ratio);
  a.lost_particles = c.lost;
  a.contacts = outcome.end.contacts;
  a.rebuilds = c.rebuilds;
  skin_ = outcome.skin;
}

protocol::BodyLoad Solver::load_of(std::size_t body, double length, const WindowOutcome& outcome) const {
  const BoundaryBody& boundary = bodies_[body];
  const PreparedPath& path = paths_[body];
  const bool moves = boundary.body != ground;
  const double share = 1.0 / plan_.steps;
  protocol::BodyLoad load;
  load.body = boundary.body.value;
  for (std::uint32_t s = 0; s < plan_.steps; ++s) {
    const Wrench& w = outcome.load[s * bodies_.size() + body];
    if (w.force == Vec3d{} && w.torque == Vec3d{}) continue;
    // The force at the beginning of a step acts over the whole step.
    const double from_middle = (s + 0.5) * plan_.dt - 0.5 * length;
    load.mean.force += w.force;
    load.mean.torque += w.torque;
    load.first_moment.force += (share * from_middle) * w.force;
    load.first_moment.torque += (share * from_middle) * w.torque;
    if (moves) {
      const BodyPose pose = pose_on_path(path, s * share);
      load.work += plan_.dt * (dot(w.force, pose.v) + dot(w.torque, pose.w));
    }
  }
  load.mean.force *= share;
  load.mean.torque *= share;
  load.end = outcome.load[(plan_.steps - 1) * bodies_.size() + body];
  return load;
}

const protocol::TangentSet& Solver::linearise() {
  const Clock::time_point begin = Clock::now();
  const double cpu_begin = cpu_seconds(CpuClock::process);
  set_last_poses();
  tangents_.time = memory_.now;
  tangents_.bodies = body_tangents(engine_->wall_tangents(poses_), surface_.boundary_bodies);
  solver_cpu_seconds_ += cpu_seconds(CpuClock::process) - cpu_begin;
  solver_seconds_ += seconds_since(begin);
  return tangents_;
}

void Solver::set_last_poses() {
  poses_.clear();
  for (std::size_t b = 0; b < memory_.bodies.size(); ++b) {
    LastMotion last = memory_.bodies[b];
    if (last.known == 0 && bodies_[b].body != ground) {
      const scene::Body& body = scene_.mbd->bodies[bodies_[b].body.value];
      last.pose = body.pose;
      last.twist = body.twist;
    }
    poses_.push_back({last.pose.p_WB, last.pose.q_WB.matrix(), last.twist.v_WB, last.twist.w_WB});
    if (belts_.any()) add_belt(poses_.back(), belts_.velocity(b, to_seconds(memory_.now)));
  }
}

std::vector<float> Solver::contacts_of_spheres() {
  set_last_poses();
  ContactsFrame found;
  engine_->download({poses_, step_taken()}, found);
  std::vector<float> values;
  values.reserve(protocol::ParticlesFrame::contact_values * found.count.size());
  for (std::size_t i = 0; i < found.count.size(); ++i) {
    values.push_back(static_cast<float>(found.count[i]));
    values.push_back(static_cast<float>(found.mean_stress[i]));
  }
  return values;
}

namespace {

// Fills the arrays of `frame`, in their memory.
void fill_spheres(protocol::ParticlesFrame& frame, const auto& download) {
  SphereFrame spheres{std::move(frame.id), std::move(frame.position), std::move(frame.velocity),
                      std::move(frame.spin), std::move(frame.radius)};
  download(spheres);
  frame.id = std::move(spheres.id);
  frame.position = std::move(spheres.position);
  frame.velocity = std::move(spheres.velocity);
  frame.spin = std::move(spheres.spin);
  frame.radius = std::move(spheres.radius);
}

}  // namespace

std::vector<double> Solver::contacts_of_bodies() {
  set_last_poses();
  std::vector<std::uint8_t> wanted;
  for (const BoundaryBody& boundary : bodies_)
    wanted.push_back(std::ranges::find(scene_.output.contacts, boundary.body) !=
                     scene_.output.contacts.end());
  std::vector<double> values;
  for (const BodyContact& contact : engine_->body_contacts({poses_, step_taken()}, wanted)) {
    const BodyId body = bodies_[contact.body].body;
    const Vec3d p = contact.point, f = contact.force;
    const double index = body == ground ? -1.0 : body.value;
    values.insert(values.end(), {index, static_cast<double>(contact.sphere), p.x, p.y, p.z, f.x, f.y, f.z});
  }
  return values;
}

const protocol::ParticlesFrame& Solver::observe() {
  fill_spheres(frame_, [&](SphereFrame& spheres) { engine_->download(spheres); });
  frame_.time = memory_.now;
  observe_contacts(frame_);
  return frame_;
}

// What is evaluated only where the scene asks for it.
void Solver::observe_contacts(protocol::ParticlesFrame& frame) {
  if (scene_.output.needs_contacts()) frame.contacts = contacts_of_spheres();
  if (!scene_.output.contacts.empty()) frame.of_bodies = contacts_of_bodies();
  if (!scene_.output.wall_fields.empty()) frame.walls = engine_->wall_fields();
}

void Solver::snapshot() {
  engine_->snapshot();
  snapshot_.time = memory_.now;
  observe_contacts(snapshot_);
}

const protocol::ParticlesFrame& Solver::read_snapshot() {
  fill_spheres(snapshot_, [&](SphereFrame& spheres) { engine_->read_snapshot(spheres); });
  return snapshot_;
}

void Solver::save() {
  engine_->save();
  saved_ = memory_;
}

void Solver::restore() {
  engine_->restore();
  memory_ = saved_;
}

protocol::Report Solver::report() {
  Spheres s;
  engine_->download(s);
  protocol::DemFacts facts;
  facts.state_hash = state_hash(s);
  facts.solver_seconds = solver_seconds_;
  facts.sphere_steps = memory_.sphere_steps;
  facts.max_speed = memory_.limits.speed;
  facts.windows_of_too_long_steps = memory_.limits.beyond_step;
  if (memory_.limits.step > 0) facts.advised_micro_step = memory_.limits.step;
  nlohmann::ordered_json others;
  others["dem_solver_cpu_seconds"] = solver_cpu_seconds_;
  others["contacts"] = loads_.account.contacts;
  others["list_rebuilds"] = loads_.account.rebuilds;
  others["skin_m"] = skin_;
  if (ranks_ != nullptr) others["rank_imbalance"] = engine_->rank_imbalance();
  if (engine_->regions() > 0) others["resident_regions"] = engine_->regions();
  others["dem_memory_MB"] = static_cast<double>(engine_->memory_bytes()) / 1e6;
  others["windows_beyond_overlap_limit"] = memory_.limits.beyond_overlap;
  others["windows_beyond_speed_limit"] = memory_.limits.beyond_speed;
  std::vector<std::string>& warnings = facts.warnings.emplace(warnings_);
  for (const std::string& sentence : watch_.warnings(memory_.limits)) warnings.push_back(sentence);
  for (const std::string& sentence : sensors_.warnings(memory_.sensors)) warnings.push_back(sentence);
  if (const std::vector<double> energy = engine_->dissipated(); !energy.empty())
    others["dem_dissipated_J"] = {{"normal_damping", energy[by_normal_damping]},
                                  {"friction", energy[by_friction]},
                                  {"rolling", energy[by_rolling]}};
  traffic_.report(memory_.traffic, facts, others);
  belts_.report(memory_.belts, others);
  if (memory_.lost_reported > 0)
    warnings.push_back(
        fmt::format("{} spheres left the domain and were taken out: use a larger dem.domain, or "
                    "dem.outlets where they are meant to leave",
                    memory_.lost_reported));
  return {protocol::encode_facts(facts, others)};
}

}  // namespace tandem::dem
