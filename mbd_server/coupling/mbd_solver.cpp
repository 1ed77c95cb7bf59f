#include "mbd_server/coupling/mbd_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/log.hpp"
#include "common/scene/parse.hpp"
#include "mbd_server/coupling/facts.hpp"
#include "mbd_server/io/state_file.hpp"
#include "mbd_server/setup/build.hpp"

namespace tandem::mbd {
namespace {

// Steps under error control are this share of the period of a harmonic function, or less.
constexpr double longest_share_of_period = 0.1;

// Adds the wall time and the processor time of its life to two sums.
class Stopwatch {
 public:
  Stopwatch(double& wall, double& cpu) : wall_(wall), cpu_(cpu) {}
  ~Stopwatch() {
    cpu_ += cpu_seconds(CpuClock::thread) - cpu_begin_;
    wall_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  double &wall_, &cpu_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double cpu_begin_ = cpu_seconds(CpuClock::thread);
};

constexpr const char* where_to_go = "; tandem run --estimate richardson measures it";

// For the log; the summary has them all.
std::string first_of(const std::vector<std::string>& names) {
  constexpr std::size_t most = 10;
  std::string list =
      fmt::format("{}", fmt::join(names.begin(), names.begin() + std::min(most, names.size()), "; "));
  if (names.size() > most) list += fmt::format("; and {} more", names.size() - most);
  return list;
}

}  // namespace

std::unique_ptr<protocol::MotionSolver> make_solver() {
  return std::make_unique<MbdSolver>();
}

MbdSolver::Machine::Machine(const scene::Scene& scene)
    : model(build_model(scene)),
      system(model),
      state(initial_state(model, scene)),
      assembly(assemble(scene, model, system, state)),
      method(scene.mbd->integrator.rho_inf,
             {scene.mbd->integrator.tolerance, scene.mbd->integrator.max_iterations}, system, state,
             scene.mbd->integrator.formulation == scene::Formulation::index3 ? Constraints::index3
                                                                             : Constraints::index2),
      contacts(model, method, system, state),
      joints(model),
      undetermined(model),
      balance(model) {
  if (scene.mbd->integrator.extrapolate) extrapolation.emplace(method, state);
  for (const scene::Joint& joint : scene.mbd->joints) joint_names.push_back(joint.name);
}

int MbdSolver::Machine::degrees_of_freedom() const {
  return model.freedoms - model.equations + static_cast<int>(system.dependent().size());
}

bool MbdSolver::Machine::redundant() const {
  return assembly.rank_deficient;
}

Integrator& MbdSolver::Machine::integrator() {
  if (extrapolation) return *extrapolation;
  return method;
}

protocol::Configured MbdSolver::configure(const protocol::Configuration& configuration) {
  return configure(scene::parse(configuration.scene_text, configuration.origin));
}

protocol::Configured MbdSolver::configure(const scene::Scene& scene) {
  machine_ = std::make_unique<Machine>(scene);
  const Model& model = machine_->model;
  step_ = scene.mbd->integrator.step;
  tolerance_ = scene.mbd->integrator.assembly_tolerance;
  const scene::Integrator& settings = scene.mbd->integrator;
  error_constant_ = std::abs(GeneralizedAlphaConstants(settings.rho_inf).error_constant());
  control_.reset();
  longest_step_ = step_.value_or(scene.coupling.window);
  if (settings.error_tolerance) {
    // Both ends of a step of a whole period see the same: the error control cannot know what lies between.
    if (model.frequency > 0) longest_step_ = std::min(longest_step_, longest_share_of_period / model.frequency);
    control_.emplace(StepControlSettings{*settings.error_tolerance, settings.min_step, longest_step_});
  }
  state_ = machine_->state;
  machine_->contacts.prepare(state_);
  machine_->integrator().start(machine_->system, state_, cut(scene.coupling.window).length);
  saved_ = aside_ = state_;
  before_.resize(model.boundary.size());
  motion_.bodies.resize(model.boundary.size());
  frame_.bodies.resize(model.bodies.size());
  frame_.joints.resize(model.joints.size());
  seconds_ = cpu_seconds_ = 0;
  loaded_ = resumed_ = false;
  totals_ = {};
  totals_.fewest_freedoms = machine_->assembly.degrees_of_freedom;

  machine_->system.residual(state_);
  note_begin();
  note_end();
  start_energy_ = energy(model, machine_->system.links());
  totals_.energy.largest_kinetic = totals_.energy.kinetic = machine_->system.kinetic_energy();
  totals_.largest_violation = constraint_violation(machine_->model, machine_->system);
  saved_totals_ = totals_;
  const AssemblyReport& assembly = machine_->assembly;
  const std::vector<Components> undetermined = machine_->undetermined.find(machine_->system, machine_->redundant());
  log::info("{} bodies, {} degrees of freedom, {} boundary bodies", model.bodies.size(),
            assembly.degrees_of_freedom, model.boundary.size());
  std::vector<std::string> closures;
  for (const Closure& closure : model.closures) closures.push_back(closure.name);
  if (!closures.empty()) log::info("loops are closed by {}", first_of(closures));
  if (!assembly.redundant.empty()) log::info("redundant equations: {}", first_of(assembly.redundant));
  std::vector<std::string> joints;
  for (std::size_t j = 0; j < undetermined.size(); ++j)
    if (undetermined[j] != 0) joints.push_back("\"" + scene.mbd->joints[j].name + "\"");
  if (!joints.empty())
    log::info("rigid mechanics does not determine all components of the reactions at joints {}", first_of(joints));
  if (assembly.moved_body != none)
    log::info("closing the loops moved body \"{}\" by {:.3g} m, and others by less", scene.mbd->bodies[assembly.moved_body].name,
              assembly.distance);
  return {motion_.bodies, configured_facts(model, scene, assembly, undetermined)};
}

const protocol::MotionSet& MbdSolver::predict(const Window& window) {
  const Stopwatch stopwatch(seconds_, cpu_seconds_);
  expect_begin(window);
  aside_ = state_;
  aside_.udot.setZero();
  return lead_aside(window);
}

const protocol::MotionSet& MbdSolver::extrapolate(const Window& window) {
  const Stopwatch stopwatch(seconds_, cpu_seconds_);
  expect_begin(window);
  aside_ = state_;
  return lead_aside(window);
}

// Along the window with the joint accelerations held.
const protocol::MotionSet& MbdSolver::lead_aside(const Window& window) {
  MachineSystem& system = machine_->system;
  const double H = window.length();
  motion_.window = window;
  system.residual(aside_);
  note_begin();

  aside_.time = aside_.side = to_seconds(window.end);
  aside_.a = H * aside_.u + (0.5 * H * H) * aside_.udot;
  aside_.u += H * aside_.udot;
  system.move(state_.q, aside_.a, aside_.q);
  system.residual(aside_);
  note_end();
  return motion_;
}

const protocol::MotionSet& MbdSolver::advance(const protocol::LoadSet& loads) {
  const Stopwatch stopwatch(seconds_, cpu_seconds_);
  expect_begin(loads.window);
  Machine& m = *machine_;
  motion_.window = loads.window;
  aside_ = state_;
  take_loads(loads);
  if (!state_.load_rates.isZero(0) || !aside_.load_rates.isZero(0))
    m.integrator().jump(m.system, aside_, state_);
  else if (state_.loads != aside_.loads)
    m.integrator().jump(m.system, state_);
  m.system.residual(state_);
  note_begin();
  m.balance.begin(state_, m.system);

  integrate(loads.window);
  expect_closed(m.model, m.system.links(), tolerance_, state_.time);
  note_end();
  record_window();
  return motion_;
}

// No step contains a break of a function of time: the steps before it end there.
void MbdSolver::integrate(const Window& window) {
  const double end = to_seconds(window.end);
  double length = window.length();
  for (double stop = next_stop(end); stop < end; stop = next_stop(end)) {
    integrate_until(stop, stop - state_.time);
    cross_break();
    length = end - stop;
  }
  integrate_until(end, length);
  cross_break();
}

// The first break before `end`, else that.
double MbdSolver::next_stop(double end) const {
  const std::vector<double>& breaks = machine_->model.breaks;
  const auto next = std::upper_bound(breaks.begin(), breaks.end(), state_.time + time_resolution(state_.time));
  return next != breaks.end() && *next < end - time_resolution(end) ? *next : end;
}

// Where the present time is a break: forces and prescribed rates jump.
void MbdSolver::cross_break() {
  const std::vector<double>& breaks = machine_->model.breaks;
  const double time = state_.time, resolution = time_resolution(time);
  const auto found = std::lower_bound(breaks.begin(), breaks.end(), time - resolution);
  if (found == breaks.end() || *found > time + resolution) {
    state_.side = time;
    return;
  }
  MachineSystem& system = machine_->system;
  aside_ = state_;
  state_.side = time;
  const double before = system.kinetic_energy();
  machine_->integrator().jump(system, aside_, state_);
  system.residual(state_);
  // What the impulse of a motion does that jumps.
  totals_.energy.add(&EnergySums::motion_work, system.kinetic_energy() - before);
  machine_->balance.begin(state_, system);
  for (std::size_t k = 0; k < before_.size(); ++k)
    before_[k] = observe_body(machine_->model, machine_->system.links(), machine_->model.boundary[k]);
}

// Steps of at most the step asked for; `length` is the time until `end` without the round-off of a difference.
void MbdSolver::integrate_until(double end, double length) {
  Machine& m = *machine_;
  const Steps steps = cut(length);
  const auto one_step = [&](double h) {
    if (control_) return control_->step(m.method, m.system, state_, std::min(state_.time + h, end));
    if (!most_iterations_)
      m.integrator().step(m.system, state_, h);
    else if (!m.method.try_step(m.system, state_, h) ||
             m.method.counters().newton_iterations > *most_iterations_)
      m.method.give_up(m.system, h);
    return h;
  };
  const StopContacts::Stride stride = std::ref(one_step);  // allocates nothing
  for (int i = 0; state_.time < end; ++i) {
    if (!control_ || i == 0)
      m.contacts.begin({.step = steps.length, .tolerance = control_ ? control_->tolerance() : 0});
    // What contacts leave of a fixed step is taken as well.
    double left = control_ ? end - state_.time : steps.length;
    do {
      const double h = m.contacts.step(state_, left, stride);
      left -= h;
      // No sum of rounded steps.
      if (control_ ? end - state_.time < 1e-6 * h : i + 1 == steps.count && left <= 1e-12 * steps.length)
        state_.time = end;
      m.system.residual(state_);
      record_step(h);
    } while (!control_ && left > 1e-12 * steps.length);
  }
}

// Held over the windows until the next call: the accelerations jump where a value does.
void MbdSolver::control(const protocol::ControlSet& inputs) {
  const Stopwatch stopwatch(seconds_, cpu_seconds_);
  if (!machine_ || std::ssize(inputs.values) != machine_->model.inputs)
    throw Error(ErrorCode::protocol,
                fmt::format("{} control inputs for {} of the scene", inputs.values.size(),
                            machine_ ? machine_->model.inputs : 0),
                "mbd_server");
  const Eigen::Map<const VectorXd> values(inputs.values.data(), std::ssize(inputs.values));
  loaded_ = true;
  if (values == state_.inputs) return;
  state_.inputs = values;
  machine_->integrator().jump(machine_->system, state_);
}

void MbdSolver::save() {
  saved_ = state_;
  saved_totals_ = totals_;
}

void MbdSolver::restore() {
  state_ = saved_;
  totals_ = saved_totals_;
}

void MbdSolver::checkpoint(const protocol::Checkpoint& file) {
  write_state(file.path, machine_->model, state_, totals_);
}

void MbdSolver::resume(const protocol::Checkpoint& file) {
  const SavedState saved = read_state(file.path, machine_->model);
  if (to_nanoseconds(saved.state.time) != file.time)
    throw Error(ErrorCode::resource,
                fmt::format("is the state at {} s, not at {} s", saved.state.time, to_seconds(file.time)),
                file.path, "give the files of one checkpoint");
  state_ = saved.state;
  state_.side = state_.time;
  totals_ = saved.totals;
  resumed_ = true;
}

// The tolerance keeps a window that is a whole number of steps from being cut once more by round-off.
MbdSolver::Steps MbdSolver::cut(double length) const {
  const int count = step_ ? std::max(1, static_cast<int>(std::ceil(length / *step_ * (1 - 1e-9)))) : 1;
  return {count, length / count};
}

void MbdSolver::expect_begin(const Window& window) const {
  if (!machine_)
    throw Error(ErrorCode::protocol, "a window was asked for before the scene was sent", "mbd_server");
  if (to_nanoseconds(state_.time) != window.begin || window.end <= window.begin)
    throw Error(ErrorCode::protocol,
                fmt::format("window {} runs from {} ns to {} ns, but the bodies are at {} ns", window.index,
                            window.begin.count, window.end.count, to_nanoseconds(state_.time).count),
                "mbd_server");
}

// Mean and first moment of a load over the window make one that is linear in time: F = mean + 12 moment / H^2
// (t - t_mid). Bodies that are not in the set carry none.
void MbdSolver::take_loads(const protocol::LoadSet& loads) {
  const auto& boundary = machine_->model.boundary;
  const double H = loads.window.length();
  state_.loads.setZero();
  state_.load_rates.setZero();
  state_.load_time = state_.time;
  for (const protocol::BodyLoad& load : loads.bodies) {
    if (load.body == ground.value) continue;
    const auto found = std::lower_bound(boundary.begin(), boundary.end(), static_cast<int>(load.body));
    if (found == boundary.end() || *found != static_cast<int>(load.body))
      throw Error(ErrorCode::protocol, fmt::format("a load on body {}, which carries no wall", load.body),
                  "mbd_server");
    const auto k = found - boundary.begin();
    const Wrench& moment = load.first_moment;
    state_.load_rates.col(k) = 12 / (H * H) * spatial(to_eigen(moment.torque), to_eigen(moment.force));
    state_.loads.col(k) =
        spatial(to_eigen(load.mean.torque), to_eigen(load.mean.force)) - (0.5 * H) * state_.load_rates.col(k);
  }
  loaded_ = loaded_ || !state_.loads.isZero(0) || !state_.load_rates.isZero(0);
}

void MbdSolver::note_begin() {
  for (std::size_t k = 0; k < motion_.bodies.size(); ++k) {
    before_[k] = observe_body(machine_->model, machine_->system.links(), machine_->model.boundary[k]);
    protocol::BodyMotion& motion = motion_.bodies[k] = {};
    motion.body = static_cast<std::uint32_t>(machine_->model.boundary[k]);
    motion.begin_pose = before_[k].pose;
    motion.begin_twist = before_[k].twist;
    motion.begin_a = before_[k].a;
    motion.begin_alpha = before_[k].alpha;
  }
}

void MbdSolver::note_end() {
  for (std::size_t k = 0; k < motion_.bodies.size(); ++k) {
    const BodyMotionState end =
        observe_body(machine_->model, machine_->system.links(), machine_->model.boundary[k]);
    protocol::BodyMotion& motion = motion_.bodies[k];
    motion.end_pose = end.pose;
    motion.end_twist = end.twist;
    motion.end_a = end.a;
    motion.end_alpha = end.alpha;
  }
}

// What the load of this step, of length h, gave to each boundary body. Over a step the velocity is linear in
// time, as the load is: the work is that of the load in the middle along the way, and h^2/12 of the product
// of their rates.
void MbdSolver::record_step(double h) {
  for (std::size_t k = 0; k < motion_.bodies.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const Vector6d rate = state_.load_rates.col(column), load = state_.load(column) - (0.5 * h) * rate;
    const Vec3d torque = to_vec3(load.head<3>()), force = to_vec3(load.tail<3>());
    const BodyMotionState now =
        observe_body(machine_->model, machine_->system.links(), machine_->model.boundary[k]);
    const BodyMotionState& last = before_[k];
    protocol::BodyMotion& motion = motion_.bodies[k];
    motion.applied_impulse.force += h * force;
    motion.applied_impulse.torque += h * torque;
    const double along_rates = dot(to_vec3(rate.tail<3>()), now.twist.v_WB - last.twist.v_WB) +
                               dot(to_vec3(rate.head<3>()), now.twist.w_WB - last.twist.w_WB);
    const double work = dot(force, now.pose.p_WB - last.pose.p_WB) +
                        dot(torque, rotation_vector(now.pose.q_WB * last.pose.q_WB.conjugate())) +
                        h * h / 12 * along_rates;
    motion.applied_work += work;
    totals_.energy.add(&EnergySums::particle_work, work);
    before_[k] = now;
  }
  machine_->balance.add_step(state_, machine_->system, h, totals_.energy);
  totals_.energy.add(&EnergySums::dissipated, machine_->contacts.take_lost());
  record_local_error(h);
  watch_energy();
  record_turn();
}

// A stiff spring that throws its mass away in one step may have it back in the next: a step that changes much is looked at by
// itself, the others window by window.
void MbdSolver::watch_energy() {
  constexpr double much = 1e-2;  // share of the largest kinetic energy
  const double kinetic = machine_->system.kinetic_energy();
  if (std::abs(kinetic - totals_.energy.kinetic) > much * totals_.energy.largest_kinetic) record_energy();
  totals_.energy.kinetic = kinetic;
}

void MbdSolver::record_energy() {
  const Machine& m = *machine_;
  const double residual =
      energy_residual(m.system.kinetic_energy() + potential_energy(m.model, m.system.links()));
  if (std::abs(residual) <= std::abs(totals_.largest_residual)) return;
  totals_.largest_residual = residual;
  totals_.largest_residual_at = state_.time;
}

// The error control bounds them, and extrapolation takes them away.
bool MbdSolver::sums_local_errors() const {
  return !control_ && !machine_->extrapolation;
}

// As the error control estimates it (generalized_alpha.hpp), with the rate of the acceleration over this step.
void MbdSolver::record_local_error(double h) {
  if (!sums_local_errors()) return;
  totals_.local_error_sum += error_constant_ * h * h * h * machine_->system.norm(state_.udot_rate);
}

double MbdSolver::energy_residual(double energy) const {
  return energy - start_energy_ - totals_.energy.work() + totals_.energy.dissipated;
}

// What a residual of the balance is to be compared with: the energy that was in motion or changed hands. Where
// next to nothing moves, 1e-9 of the weight times the size of the machine, of its kinetic energy at one size in
// the time of the run, and of what springs have stored: round-off is far below, motion far above.
double MbdSolver::energy_scale() const {
  const Machine& m = *machine_;
  const double speed = state_.time > 0 ? m.model.size / state_.time : 0;
  double mass = 0, weight = 0;
  for (const BodyOnLink& body : m.model.bodies) {
    mass += body.mass;
    weight += body.mass * m.model.gravity.dot(m.model.origin + m.system.links()[body.link].point(body.p_LB));
  }
  const double stored = std::abs(potential_energy(m.model, m.system.links()) + weight);
  const double least = 1e-9 * (mass * (m.model.gravity.norm() * m.model.size + speed * speed) + stored);
  return std::max({totals_.energy.largest_kinetic, totals_.energy.turnover, least});
}

// Where two ways of a loop cross, data of a few digits make one of them turn into the other: a hyperbola, whose curvature
// per way is about the inverse of the sine there. A machine that hardly moves turns sharply for other reasons.
void MbdSolver::record_turn() {
  constexpr double moving = 1e-3;  // share of the largest kinetic energy
  const Machine& m = *machine_;
  if (m.model.equations == 0 || m.system.elimination().smallest_sine() > std::sqrt(tolerance_)) return;
  if (m.system.kinetic_energy() < moving * energy_scale()) return;
  const double turn = m.system.curvature(state_);
  if (turn <= totals_.sharpest_turn) return;
  totals_.sharpest_turn = turn;
  totals_.sharpest_turn_at = state_.time;
  totals_.sharpest_turn_closure = m.system.elimination().tightest_closure();
}

void MbdSolver::record_window() {
  const Machine& m = *machine_;
  record_energy();
  totals_.largest_violation = std::max(totals_.largest_violation, constraint_violation(m.model, m.system));
  totals_.fewest_freedoms = std::min(totals_.fewest_freedoms, static_cast<double>(m.degrees_of_freedom()));
}

void MbdSolver::record_reactions(const std::vector<JointObservation>& joints) {
  const Machine& m = *machine_;
  totals_.reaction_scale =
      std::max(totals_.reaction_scale, force_scale(m.model, state_, m.system.links()));
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Wrench& reaction = joints[j].reaction;
    const double size = std::max(norm(reaction.force), norm(reaction.torque) / m.model.size);
    if (size <= totals_.largest_reaction) continue;
    totals_.largest_reaction = size;
    totals_.largest_reaction_joint = static_cast<double>(j);
  }
}

const protocol::BodiesFrame& MbdSolver::observe() {
  Machine& m = *machine_;
  m.system.residual(state_);
  const auto& links = m.system.links();
  frame_.time = to_nanoseconds(state_.time);
  for (std::size_t b = 0; b < frame_.bodies.size(); ++b) {
    const BodyMotionState seen = observe_body(m.model, links, static_cast<int>(b));
    frame_.bodies[b] = {static_cast<std::uint32_t>(b), 0, seen.pose, seen.twist};
  }
  const auto& joints = m.joints.observe(state_, links);
  record_reactions(joints);
  const std::vector<Components>& undetermined = m.undetermined.find(m.system, m.redundant());
  for (std::size_t j = 0; j < joints.size(); ++j)
    frame_.joints[j] = {static_cast<std::uint32_t>(j), undetermined[j], joints[j].q, joints[j].rate, joints[j].reaction};
  frame_.energy = energy(m.model, links);
  return frame_;
}

// Why the error of the run cannot be measured by running the machine alone once more; empty: it can.
std::string MbdSolver::obstacle_to_estimate() const {
  if (loaded_) return "loads of particles or a controller act";
  if (control_) return "steps are those of the error control";
  if (machine_->extrapolation) return "the error of second order is extrapolated";
  if (resumed_) return "the run was continued from a file";
  if (machine_->contacts.counters().contacts > 0) return "joints meet their stops";
  if (machine_->method.shortened().count > 0) return "steps were taken in parts";
  if (steps_for_estimate(static_cast<double>(state_.steps)) < 10) return "there are too few steps";
  return {};
}

RunEnd MbdSolver::run_end() {
  Machine& m = *machine_;
  m.system.residual(state_);
  RunEnd end;
  for (int b = 0; b < std::ssize(m.model.bodies); ++b)
    end.bodies.push_back(observe_body(m.model, m.system.links(), b).pose);
  end.energy = energy(m.model, m.system.links());
  end.steps = static_cast<double>(state_.steps);
  return end;
}

// The motion once more from the start, without loads, in about so many steps. None where the steps are too long.
std::optional<RunEnd> MbdSolver::run_again(double end, double steps) {
  Machine& m = *machine_;
  const Window window{0, {}, to_nanoseconds(end)};
  step_ = end / steps;
  state_ = m.state;
  m.contacts.prepare(state_);
  try {
    m.integrator().start(m.system, state_, cut(end).length);
    m.system.residual(state_);
    note_begin();
    m.balance.begin(state_, m.system);
    integrate(window);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::numerics) throw;
    return {};
  }
  return run_end();
}

ErrorEstimate MbdSolver::measure_error() {
  if (const std::string obstacle = obstacle_to_estimate(); !obstacle.empty())
    return {{}, {}, {}, obstacle + where_to_go};
  const RunEnd run = run_end();
  const State state = state_;
  const RunTotals totals = totals_;
  const GeneralizedAlpha method = machine_->method;
  const std::optional<double> step = step_;
  const std::uint64_t iterations = method.counters().newton_iterations;
  most_iterations_ = iterations + iterations * 3 / 20;
  const double steps = steps_for_estimate(run.steps), cpu_begin = cpu_seconds(CpuClock::thread);
  // Their errors are at least (run.steps / steps)^2 times as large.
  machine_->method.loosen(run.steps * run.steps / (steps * steps));
  const std::optional<RunEnd> coarse = run_again(state.time, steps);
  double taken = static_cast<double>(state_.steps);
  std::optional<RunEnd> coarser;
  if (coarse) {
    coarser = run_again(state.time, steps / 2);
    taken += static_cast<double>(state_.steps);
  }
  state_ = state;
  totals_ = totals;
  step_ = step;
  most_iterations_.reset();
  machine_->method = method;
  ErrorEstimate estimate;
  if (coarser)
    estimate = estimate_error(run, *coarse, *coarser);
  else
    estimate.reason = unresolved;
  if (!estimate.reason.empty()) estimate.reason += where_to_go;
  estimate.steps = taken;
  estimate.cpu_seconds = cpu_seconds(CpuClock::thread) - cpu_begin;
  const Model& model = machine_->model;
  // Where energy is only stored the balance is the error.
  if (!model.damped && !model.driven && !model.powered) estimate.energy = std::abs(energy_residual(run.energy));
  return estimate;
}

protocol::Report MbdSolver::report() {
  Machine& m = *machine_;
  m.system.residual(state_);
  record_reactions(m.joints.observe(state_, m.system.links()));
  const double now = energy(m.model, m.system.links());
  const auto loaded = static_cast<std::ptrdiff_t>(totals_.largest_reaction_joint);
  const auto turned = static_cast<std::ptrdiff_t>(totals_.sharpest_turn_closure);
  RunFigures figures{.state_hash = hash(state_),
                        .counters = m.method.counters(),
                        .stops = m.contacts.counters(),
                        .shortened = m.method.shortened(),
                        .solver_seconds = seconds_,
                        .solver_cpu_seconds = cpu_seconds_,
                        .local_error_sum = sums_local_errors() ? std::optional(totals_.local_error_sum) : std::nullopt,
                        .constraint_violation = constraint_violation(m.model, m.system),
                        .start_energy = start_energy_,
                        .end_energy = now,
                        .energy_residual = energy_residual(now),
                        .energy_scale = energy_scale(),
                        .degrees_of_freedom = m.degrees_of_freedom(),
                        .size = m.model.size,
                        .periods_per_step = longest_step_ * m.model.frequency,
                        .most_loaded_joint = loaded < 0 ? "" : m.joint_names[static_cast<std::size_t>(loaded)],
                        .sharpest_turn_loop = turned < 0 ? "" : m.model.closures[static_cast<std::size_t>(turned)].name,
                        .totals = totals_,
                        .error = {}};
  figures.error = measure_error();
  return {report_facts(figures)};
}

}  // namespace tandem::mbd
