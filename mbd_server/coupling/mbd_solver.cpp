#include "mbd_server/coupling/mbd_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/log.hpp"
#include "common/scene/no_solver_options.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/plain_text.hpp"
#include "mbd_server/coupling/contact_tangents.hpp"
#include "mbd_server/coupling/facts.hpp"
#include "mbd_server/io/state_file.hpp"
#include "mbd_server/setup/build.hpp"
#include "mbd_server/solve/modes.hpp"
#include "protocol/start_files.hpp"

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

// For the log: the first name and the number of others; the summary lists all names.
std::string first_of(const std::vector<std::string>& names) {
  constexpr std::size_t most = 10;
  std::string list =
      fmt::format("{}", fmt::join(names.begin(), names.begin() + std::min(most, names.size()), "; "));
  if (names.size() > most) list += fmt::format("; and {} more", names.size() - most);
  return list;
}

// The explicit method has no multipliers.
void expect_tree(const Model& model) {
  if (model.closures.empty()) return;
  std::vector<std::string> names;
  for (const Closure& closure : model.closures) names.push_back(closure.name);
  throw Error(
      ErrorCode::scene,
      fmt::format("'dormand_prince' is for machines without closed loops, and {} closed by {}",
                  names.size() == 1 ? "one is" : fmt::format("{} are", names.size()), first_of(names)),
      "mbd.integrator.method", "leave out method, which is then generalized_alpha");
}

}  // namespace

std::unique_ptr<protocol::MotionSolver> make_solver() {
  return std::make_unique<MbdSolver>();
}

MbdSolver::Machine::Machine(const scene::Scene& scene, const std::vector<NamedMesh>& meshes,
                            const StartLoads& loads)
    : model(build_model(scene, meshes)),
      system(model),
      state(initial_state(model, scene)),
      assembly(assemble(scene, model, system, state)),
      method(scene.mbd->integrator.rho_inf,
             {scene.mbd->integrator.tolerance, scene.mbd->integrator.max_iterations}, system, state,
             scene.mbd->integrator.formulation == scene::Formulation::index3 ? Constraints::index3
                                                                             : Constraints::index2),
      contacts(model, method, system, state),
      stiction(model, method, system, state),
      touching(model, method, system, state, contacts, stiction),
      islands(model, scene.mbd->integrator.rho_inf,
              {scene.mbd->integrator.tolerance, scene.mbd->integrator.max_iterations}),
      time_stepping(model),
      joints(model),
      undetermined(model),
      balance(model),
      elements(model, scene::elements_of(scene)),
      bottoming(model),
      machine_elements(forces_of<Element>(model)) {
  for (std::size_t k = 0; k < model.boundary.size(); ++k)
    if (const auto of = loads.find(static_cast<std::uint32_t>(model.boundary[k])); of != loads.end())
      state.loads.col(static_cast<Eigen::Index>(k)) =
          spatial(to_eigen(of->second.torque), to_eigen(of->second.force));
  if (scene.mbd->start == scene::Start::equilibrium) equilibrium = find_equilibrium(model, system, state);
  if (scene.mbd->integrator.extrapolate) extrapolation.emplace(method, state);
  if (scene.mbd->integrator.method == scene::IntegrationMethod::dormand_prince) {
    expect_tree(model);
    explicit_method.emplace(system, state);
  }
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
  return controlled();
}

ControlledMethod& MbdSolver::Machine::controlled() {
  if (explicit_method) return *explicit_method;
  return method;
}

protocol::Configured MbdSolver::configure(const protocol::Configuration& configuration) {
  const scene::Scene scene = scene::parse(configuration.scene_text, configuration.origin);
  scene::expect_masses(scene, configuration.origin);
  if (scene.mbd)
    scene::expect_no_solver_options(scene.mbd->solver_options, configuration.origin, "mbd", "mbd_server");
  return configure(scene, configuration.meshes, protocol::start_loads(configuration.files));
}

protocol::Configured MbdSolver::configure(const scene::Scene& scene, const std::vector<NamedMesh>& meshes,
                                          const StartLoads& loads) {
  machine_ = std::make_unique<Machine>(scene, meshes, loads);
  const Model& model = machine_->model;
  step_ = scene.mbd->integrator.step;
  tolerance_ = scene.mbd->integrator.assembly_tolerance;
  const scene::Integrator& settings = scene.mbd->integrator;
  error_constant_ = std::abs(GeneralizedAlphaConstants(settings.rho_inf).error_constant());
  control_.reset();
  longest_step_ = step_.value_or(scene.coupling.window);
  nominal_step_ = cut(scene.coupling.window).length;
  window_ = scene.coupling.window;
  if (settings.error_tolerance) {
    // A step of a whole period has equal values at both of its ends, so that the error control would not
    // see the oscillation.
    if (model.frequency > 0)
      longest_step_ = std::min(longest_step_, longest_share_of_period / model.frequency);
    control_.emplace(StepControlSettings{*settings.error_tolerance, settings.min_step, longest_step_});
  }
  state_ = machine_->state;
  const bool keeps_loads = !control_ && !machine_->extrapolation && !machine_->explicit_method;
  journal_ = keeps_loads ? LoadJournal(scene.end_time / scene.coupling.window, state_) : LoadJournal();
  machine_->contacts.prepare(state_);
  machine_->stiction.prepare(state_);
  machine_->touching.prepare(state_);
  machine_->integrator().start(machine_->system, state_, cut(scene.coupling.window).length);
  machine_->touching.note_start(state_, cut(scene.coupling.window).length);
  machine_->islands.prepare(state_);
  machine_->time_stepping.prepare(state_);
  predicted_ = state_;
  before_.resize(model.boundary.size());
  motion_.bodies.resize(model.boundary.size());
  frame_.bodies.resize(model.bodies.size());
  frame_.joints.resize(model.joints.size());
  seconds_ = cpu_seconds_ = 0;
  loaded_ = resumed_ = false;
  totals_ = {};
  for (std::vector<double>* list :
       {&totals_.local_errors, &totals_.short_step_errors, &totals_.least, &totals_.most})
    list->assign(static_cast<std::size_t>(model.freedoms), 0);
  moved_ = local_error_ = VectorXd::Zero(model.freedoms);
  totals_.energy.work_of.assign(static_cast<std::size_t>(model.accounts), 0);
  totals_.energy.lost_of = totals_.energy.work_of;
  if (!model.contact.empty()) totals_.contact_impulses.assign(6 * model.boundary.size(), 0);
  totals_.tyres = machine_->bottoming.totals();
  prescribed_.clear();
  for (std::size_t i = 0; i < model.links.size(); ++i)
    if (model.links[i].motion != none) prescribed_.push_back(static_cast<LinkIndex>(i));
  rates_before_.resize(prescribed_.size());
  totals_.fewest_freedoms = machine_->assembly.degrees_of_freedom;

  machine_->system.residual(state_);
  record_begin_motion();
  record_end_motion();
  start_energy_ = energy(model, state_, machine_->system.links());
  machine_->elements.start(state_, machine_->system);
  totals_.energy.largest_kinetic = totals_.energy.kinetic = machine_->system.kinetic_energy();
  totals_.largest_violation = constraint_violation(machine_->model, machine_->system);
  save();
  const AssemblyReport& assembly = machine_->assembly;
  const std::vector<Components> undetermined =
      machine_->undetermined.find(machine_->system, machine_->redundant());
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
    log::info("rigid mechanics does not determine all components of the reactions at joints {}",
              first_of(joints));
  warn_of_instability();
  if (const auto& found = machine_->equilibrium)
    log::info(
        "the machine starts in its equilibrium, found in {} iterations; the largest change is {:.3g} rad or "
        "sizes of the machine, at {}{}",
        found->iterations, found->distance, found->moved,
        found->state_change > 0 ? fmt::format("; that of a state is {:.3g} of its scale, at the {}",
                                              found->state_change, found->changed_state)
                                : "");
  if (assembly.moved_body != none)
    log::info("closing the loops moved body \"{}\" by {:.3g} m, and others by less",
              scene.mbd->bodies[assembly.moved_body].name, assembly.distance);
  return {motion_.bodies, configured_facts(model, scene, assembly, undetermined)};
}

// A machine in an unstable equilibrium stays there in a simulation, and in no other place.
void MbdSolver::warn_of_instability() {
  constexpr int most = 200;  // freedoms: the search for the modes is dense
  constexpr double real = 1e-6;
  Machine& m = *machine_;
  unstable_start_.clear();
  if (!m.equilibrium || m.model.freedoms > most) return;
  for (const Mode& mode : find_modes(m.model, m.system, m.state).modes) {
    if (!(mode.s.real() > real * std::abs(mode.s))) continue;
    Eigen::Index widest = 0;
    mode.shape.cwiseAbs().maxCoeff(&widest);
    unstable_start_ =
        fmt::format("the equilibrium at the start is unstable: {} leaves it with a time constant of {:.3g} s",
                    m.model.coordinate_names[static_cast<std::size_t>(widest)], 1 / mode.s.real());
    log::warn("{}", unstable_start_);
    return;
  }
}

const protocol::MotionSet& MbdSolver::predict(const Window& window) {
  const Stopwatch stopwatch(seconds_, cpu_seconds_);
  expect_begin(window);
  predicted_ = state_;
  predicted_.udot.setZero();
  return hold_accelerations(window);
}

const protocol::MotionSet& MbdSolver::extrapolate(const Window& window) {
  const Stopwatch stopwatch(seconds_, cpu_seconds_);
  expect_begin(window);
  predicted_ = state_;
  return hold_accelerations(window);
}

// Motion over the window with constant joint accelerations.
const protocol::MotionSet& MbdSolver::hold_accelerations(const Window& window) {
  MachineSystem& system = machine_->system;
  const double H = window.length();
  motion_.window = window;
  system.residual(predicted_);
  record_begin_motion();

  predicted_.time = predicted_.side = to_seconds(window.end);
  predicted_.a = H * predicted_.u + (0.5 * H * H) * predicted_.udot;
  predicted_.u += H * predicted_.udot;
  system.move(state_.q, predicted_.a, predicted_.q);
  system.residual(predicted_);
  record_end_motion();
  return motion_;
}

const protocol::MotionSet& MbdSolver::advance(const protocol::LoadSet& loads) {
  const Stopwatch stopwatch(seconds_, cpu_seconds_);
  expect_begin(loads.window);
  Machine& m = *machine_;
  motion_.window = loads.window;
  predicted_ = state_;
  take_loads(loads);
  jump_to_loads();
  m.system.residual(state_);
  record_begin_motion();
  m.balance.begin(state_, m.system);

  integrate(loads.window);
  expect_closed(m.model, m.system.links(), tolerance_, state_.time);
  record_end_motion();
  record_window();
  if (!control_ && !m.extrapolation && !m.explicit_method && !resumed_) journal_.note(loads.window, state_);
  return motion_;
}

// The inputs are held over the windows until the next call; the accelerations jump where an input does.
void MbdSolver::control(const protocol::ControlSet& inputs) {
  const Stopwatch stopwatch(seconds_, cpu_seconds_);
  if (!machine_ || std::ssize(inputs.values) != machine_->model.inputs)
    throw Error(ErrorCode::protocol,
                fmt::format("{} control inputs for {} of the scene", inputs.values.size(),
                            machine_ ? machine_->model.inputs : 0),
                "mbd_server");
  const Eigen::Map<const VectorXd> values(inputs.values.data(), std::ssize(inputs.values));
  loaded_ = true;
  for (const InputRange& range : machine_->model.input_ranges)
    if (const double value = values[range.input]; !(value >= range.lowest && value <= range.highest))
      throw Error(ErrorCode::protocol, fmt::format("the controller asks for {:.6g} at {}", value, range.of),
                  "mbd_server", fmt::format("send a value from {} to {}", range.lowest, range.highest));
  if (values == state_.inputs) return;
  state_.inputs = values;
  machine_->integrator().jump(machine_->system, state_);
}

const protocol::TangentSet& MbdSolver::linearise() {
  const Stopwatch stopwatch(seconds_, cpu_seconds_);
  machine_->system.residual(state_);
  tangents_.time = to_nanoseconds(state_.time);
  contact_tangents(machine_->model, state_, machine_->system.links(), tangents_.bodies);
  return tangents_;
}

void MbdSolver::save() {
  saved_.state = state_;
  saved_.totals = totals_;
  saved_windows_ = journal_.size();
}

void MbdSolver::restore() {
  state_ = saved_.state;
  totals_ = saved_.totals;
  journal_.keep(saved_windows_);
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

void MbdSolver::expect_begin(const Window& window) const {
  if (!machine_)
    throw Error(ErrorCode::protocol, "a window was asked for before the scene was sent", "mbd_server");
  if (to_nanoseconds(state_.time) != window.begin || window.end <= window.begin)
    throw Error(ErrorCode::protocol,
                fmt::format("window {} runs from {} ns to {} ns, but the bodies are at {} ns", window.index,
                            window.begin.count, window.end.count, to_nanoseconds(state_.time).count),
                "mbd_server");
}

// Converts the mean and the first moment of a load over the window into a load that is linear in time:
// F = mean + 12 moment / H^2 (t - t_mid). Bodies that are not in the set have no load.
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

// The accelerations jump where the loads do; predicted_ is the state before.
void MbdSolver::jump_to_loads() {
  Machine& m = *machine_;
  if (!state_.load_rates.isZero(0) || !predicted_.load_rates.isZero(0))
    m.integrator().jump(m.system, predicted_, state_);
  else if (state_.loads != predicted_.loads)
    m.integrator().jump(m.system, state_);
}

}  // namespace tandem::mbd
