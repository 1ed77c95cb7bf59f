#include "dem_server/coupling/load_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/log.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/time_step.hpp"
#include "dem_server/coupling/make_solver.hpp"
#include "dem_server/coupling/state_hash.hpp"
#include "dem_server/coupling/tangents.hpp"
#include "dem_server/io/fill.hpp"

namespace tandem::dem {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// The list lives until two spheres have closed the skin between them: a thicker one is rebuilt less often and
// holds more candidates that do not touch. A quarter of a radius is flat near the optimum
// (docs/performance.md).
double default_skin(const std::vector<double>& radii) {
  double sum = 0;
  for (const double r : radii) sum += r;
  return radii.empty() ? 0.0 : 0.25 * sum / static_cast<double>(radii.size());
}

Spheres to_spheres(const Fill& fill) {
  Spheres s;
  const std::size_t n = fill.position.size();
  s.position = fill.position;
  s.velocity = fill.velocity;
  s.spin.resize(n);
  s.radius = fill.radius;
  s.material = fill.material;
  for (std::size_t i = 0; i < n; ++i) s.id.push_back(static_cast<std::uint32_t>(i));
  return s;
}

// Bound of |f'| over a cubic Hermite that moves by `mean` with the end rates `begin` and `end`: the
// derivative is mean + b(s) (begin - mean) + e(s) (end - mean) with |b|, |e| <= 1.
double rate_bound(Vec3d mean, Vec3d begin, Vec3d end) {
  return norm(mean) + norm(begin - mean) + norm(end - mean);
}

}  // namespace

std::unique_ptr<protocol::LoadSolver> make_solver() {
  return std::make_unique<Solver>();
}

protocol::Configured Solver::configure(const protocol::Configuration& configuration) {
  const Clock::time_point begin = Clock::now();
  scene_ = scene::parse(configuration.scene_text, configuration.origin);
  if (!scene_.dem)
    throw Error(ErrorCode::scene, "has no 'dem'", configuration.origin, "no dem_server is needed");

  std::vector<NamedParticles> files;
  for (const protocol::NamedText& file : configuration.files)
    files.push_back({file.name, scene::read_particle_file(file.text, file.name)});
  const Fill fill = make_fill(scene_, files);
  const Spheres spheres = to_spheres(fill);
  spheres_ = spheres.size();
  const double skin = scene_.dem->skin.value_or(default_skin(spheres.radius));
  const double largest = spheres_ == 0 ? 0 : *std::max_element(spheres.radius.begin(), spheres.radius.end());
  surface_ = make_surface(scene_, configuration.meshes, largest + skin);
  check_start(fill, surface_, scene_);
  choose_micro_step(spheres);

  const Vec3d domain = scene_.dem->domain.max - scene_.dem->domain.min;
  for (std::size_t slot = 0; slot < surface_.slot_body.size(); ++slot) {
    const BodyId body = surface_.slot_body[slot];
    // A plane on a moving body reaches as far as there are spheres.
    const bool endless = body != ground && surface_.grids[slot].planes > 0;
    carriers_.push_back(
        {body, scene_.body_name(body), endless ? norm(domain) : surface_.slot_extent[slot], {}, {}, false});
  }

  choice_ = choose_engine(scene_, choose_backend(configuration.backend));
  engine_ = make_engine(choice_, {scene_, surface_, spheres, skin, configuration.threads});
  const std::string device = device_name(choice_.backend);
  log::info("{} spheres on {} ({}), variant {}, micro step {:.4g} s, {:.1f} MB", spheres_,
            choice_.backend == Backend::cuda ? "cuda" : "cpu", device, choice_.variant, largest_step_,
            static_cast<double>(engine_->memory_bytes()) / 1e6);
  if (choice_.generic_fallback && !scene_.dem->force_generic)
    log::info("no special variant for this law and precision: the generic one runs");
  for (const std::string& what : choice_.left_out) log::info("left out: {}", what);

  nlohmann::json facts;
  facts["backend"] = choice_.backend == Backend::cuda ? "cuda" : "cpu";
  facts["device"] = device;
  facts["precision"] = scene_.dem->precision == scene::Precision::mixed ? "mixed" : "double";
  facts["variant"] = choice_.variant;
  facts["left_out"] = choice_.left_out;
  facts["spheres"] = spheres_;
  facts["micro_step_s"] = largest_step_;
  facts["skin_m"] = skin;
  facts["dem_setup_seconds"] = seconds_since(begin);
  return {{}, facts.dump()};
}

void Solver::choose_micro_step(const Spheres& spheres) {
  const scene::Dem& dem = *scene_.dem;
  double critical = std::numeric_limits<double>::infinity();
  for (std::uint32_t m = 0; m < dem.materials.size(); ++m) {
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < spheres.size(); ++i)
      if (spheres.material[i] == m) smallest = std::min(smallest, spheres.radius[i]);
    if (std::isfinite(smallest))
      critical = std::min(critical, scene::critical_time(dem, MaterialId{m}, smallest));
  }
  largest_step_ = dem.micro_step.value_or(scene::automatic_step_share * critical);
  if (largest_step_ > scene::largest_step_share * critical)
    throw Error(ErrorCode::scene,
                fmt::format("the micro step is {:.4g} s, above {:.4g} s, the limit for the smallest sphere",
                            largest_step_, scene::largest_step_share * critical),
                "dem.micro_step",
                fmt::format("use at most that, or leave it out for {:.4g} s",
                            scene::automatic_step_share * critical));
}

const protocol::LoadSet& Solver::advance(const protocol::MotionSet& motion) {
  const Clock::time_point begin = Clock::now();
  const double cpu_begin = cpu_seconds(CpuClock::process);  // of all threads that share the particles
  const double length = motion.window.length();
  // A whole number of micro steps, none longer than the one asked for (but for the rounding of the quotient).
  plan_.steps = static_cast<std::uint32_t>(std::ceil(length / largest_step_ * (1 - 1e-12)));
  plan_.dt = length / plan_.steps;
  set_paths(motion);
  const WindowOutcome& outcome = engine_->advance(plan_);
  book_loads(motion.window, outcome);
  now_ = motion.window.end;
  micro_steps_ += plan_.steps;
  solver_cpu_seconds_ += cpu_seconds(CpuClock::process) - cpu_begin;
  solver_seconds_ += seconds_since(begin);
  if (outcome.control.lost > lost_reported_) {
    const std::string sentence =
        fmt::format("{} spheres have left the domain by t = {:.6g} s and were taken out",
                    outcome.control.lost, to_seconds(now_));
    if (lost_reported_ == 0) log::warn("{}", sentence);
    lost_reported_ = outcome.control.lost;
  }
  return loads_;
}

void Solver::set_paths(const protocol::MotionSet& motion) {
  const double length = motion.window.length();
  paths_.clear();
  plan_.body_speed = plan_.wall_jump = 0;
  for (Carrier& carrier : carriers_) {
    PathSegment segment;  // the ground: at rest in the world's origin
    if (carrier.body != ground) {
      const auto found =
          std::find_if(motion.bodies.begin(), motion.bodies.end(),
                       [&](const protocol::BodyMotion& m) { return m.body == carrier.body.value; });
      if (found == motion.bodies.end())
        throw Error(ErrorCode::protocol, "no motion of body '" + carrier.name + "', which carries walls",
                    "motion", "the multibody side must send every boundary body");
      segment = {found->begin_pose, found->end_pose, found->begin_twist, found->end_twist};
    }
    const PreparedPath path = prepare_path(segment, length, carrier.name.c_str());
    const double linear = rate_bound((1 / length) * (segment.end.p_WB - segment.begin.p_WB),
                                     segment.begin_twist.v_WB, segment.end_twist.v_WB);
    const double angular = rate_bound((1 / length) * path.turn, (1 / length) * path.turn_rate_begin,
                                      (1 / length) * path.turn_rate_end);
    plan_.body_speed = std::max(plan_.body_speed, linear + angular * carrier.extent);
    if (carrier.placed) {
      const double turn = norm(rotation_vector(path.segment.begin.q_WB * carrier.pose.q_WB.conjugate()));
      const double jump = norm(path.segment.begin.p_WB - carrier.pose.p_WB) + turn * carrier.extent;
      plan_.wall_jump = std::max(plan_.wall_jump, jump);
    }
    carrier.pose = path.segment.end;
    carrier.twist = path.segment.end_twist;
    carrier.placed = true;
    paths_.push_back(path);
  }
  plan_.paths = paths_;
}

void Solver::book_loads(const Window& window, const WindowOutcome& outcome) {
  const Control& c = outcome.control;
  loads_.window = window;
  loads_.bodies.clear();
  for (std::size_t slot = 0; slot < carriers_.size(); ++slot)
    loads_.bodies.push_back(load_of(slot, window.length(), outcome));
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
}

protocol::BodyLoad Solver::load_of(std::size_t slot, double length, const WindowOutcome& outcome) const {
  const Carrier& carrier = carriers_[slot];
  const PreparedPath& path = paths_[slot];
  const bool moves = carrier.body != ground;
  const double share = 1.0 / plan_.steps;
  protocol::BodyLoad load;
  load.body = carrier.body.value;
  for (std::uint32_t s = 0; s < plan_.steps; ++s) {
    const Wrench& w = outcome.load[s * carriers_.size() + slot];
    if (w.force == Vec3d{} && w.torque == Vec3d{}) continue;
    // The force found at a step's begin acts over the step.
    const double from_middle = (s + 0.5) * plan_.dt - 0.5 * length;
    load.mean.force += w.force;
    load.mean.torque += w.torque;
    load.first_moment.force += (share * from_middle) * w.force;
    load.first_moment.torque += (share * from_middle) * w.torque;
    if (moves) {
      const BodyPose body = pose_on_path(path, s * share);
      load.work += plan_.dt * (dot(w.force, body.v) + dot(w.torque, body.w));
    }
  }
  load.mean.force *= share;
  load.mean.torque *= share;
  load.end = outcome.load[(plan_.steps - 1) * carriers_.size() + slot];
  return load;
}

const protocol::TangentSet& Solver::linearise() {
  const Clock::time_point begin = Clock::now();
  const double cpu_begin = cpu_seconds(CpuClock::process);
  poses_.clear();
  for (const Carrier& carrier : carriers_)
    poses_.push_back({carrier.pose.p_WB, carrier.pose.q_WB.matrix(), carrier.twist.v_WB, carrier.twist.w_WB});
  tangents_.time = now_;
  tangents_.bodies = sum_tangents(engine_->wall_tangents(poses_), surface_.slot_body);
  solver_cpu_seconds_ += cpu_seconds(CpuClock::process) - cpu_begin;
  solver_seconds_ += seconds_since(begin);
  return tangents_;
}

const protocol::ParticlesFrame& Solver::observe() {
  Spheres s;
  engine_->download(s);
  frame_.time = now_;
  frame_.id = s.id;
  frame_.position.clear();
  frame_.velocity.clear();
  frame_.spin.clear();
  frame_.radius.clear();
  for (std::size_t i = 0; i < s.size(); ++i) {
    for (int a = 0; a < 3; ++a) {
      frame_.position.push_back(s.position[i][a]);
      frame_.velocity.push_back(static_cast<float>(s.velocity[i][a]));
      frame_.spin.push_back(static_cast<float>(s.spin[i][a]));
    }
    frame_.radius.push_back(static_cast<float>(s.radius[i]));
  }
  return frame_;
}

void Solver::save() {
  engine_->save();
  saved_carriers_ = carriers_;
  saved_now_ = now_;
  saved_micro_steps_ = micro_steps_;
}

void Solver::restore() {
  engine_->restore();
  carriers_ = saved_carriers_;
  now_ = saved_now_;
  micro_steps_ = saved_micro_steps_;
}

protocol::Report Solver::report() {
  Spheres s;
  engine_->download(s);
  nlohmann::json facts;
  facts["dem_state_hash"] = state_hash(s);
  facts["solver_seconds"] = solver_seconds_;
  facts["dem_solver_cpu_seconds"] = solver_cpu_seconds_;
  facts["contacts"] = loads_.account.contacts;
  facts["list_rebuilds"] = loads_.account.rebuilds;
  facts["dem_memory_MB"] = static_cast<double>(engine_->memory_bytes()) / 1e6;
  facts["warnings"] = nlohmann::json::array();
  if (lost_reported_ > 0)
    facts["warnings"].push_back(fmt::format("{} spheres left the domain and were taken out", lost_reported_));
  if (loads_.account.max_overlap_ratio > 0.05)
    facts["warnings"].push_back(fmt::format(
        "the largest overlap was {:.3g} of the smaller radius; Hertz's law is meant for a few per cent: "
        "use a stiffer material",
        loads_.account.max_overlap_ratio));
  return {facts.dump()};
}

}  // namespace tandem::dem
