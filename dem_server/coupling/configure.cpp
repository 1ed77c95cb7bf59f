// Builds the engine of a scene before the first window, with the checks that need the spheres.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/scene/no_solver_options.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/plain_text.hpp"
#include "dem_server/contact/parameters.hpp"
#include "dem_server/coupling/load_solver.hpp"
#include "dem_server/coupling/ranked_solver.hpp"
#include "dem_server/engine/wall_rows.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "dem_server/laws/step_limits.hpp"
#include "particles/base/memory.hpp"
#include "particles/grid/size_levels.hpp"
#include "particles/io/fill.hpp"
#include "protocol/codec.hpp"
#include "protocol/facts.hpp"
#include "protocol/frame.hpp"

namespace tandem::dem {
namespace {

Spheres to_spheres(const Fill& fill) {
  Spheres s;
  const std::size_t n = fill.position.size();
  s.position = fill.position;
  s.velocity = fill.velocity;
  s.spin = fill.spin;
  s.radius = fill.radius;
  s.material = fill.material;
  for (std::size_t i = 0; i < n; ++i) s.id.push_back(static_cast<std::uint32_t>(i));
  return s;
}

}  // namespace

protocol::Configured Solver::configure(const protocol::Configuration& configuration) {
  const auto begin = std::chrono::steady_clock::now();
  scene_ = scene::parse(configuration.scene_text, configuration.origin);
  scene::expect_masses(scene_, configuration.origin);
  if (!scene_.dem)
    throw Error(ErrorCode::scene, "has no 'dem'", configuration.origin, "no dem_server is needed");
  scene::expect_no_solver_options(scene_.dem->solver_options, configuration.origin, "dem", "dem_server");

  std::vector<NamedParticles> files;
  for (const protocol::NamedText& file : configuration.files)
    files.push_back({file.name, scene::read_particle_file(file.text, file.name)});
  Fill fill = make_fill(scene_, files);
  const std::vector<FixedSphere> fixed = make_fixed(scene_, files);
  const std::vector<Inlet> inlets = make_inlets(scene_);
  for (const Inlet& inlet : inlets)
    if (inlet.due.empty() || !(inlet.due.front() < scene_.end_time))
      warn(
          fmt::format("inlet '{}' starts at {} s, so that no sphere comes in before the end at {} s: give an "
                      "earlier start, or a later end_time",
                      inlet.name, inlet.fill.start, scene_.end_time));
  std::vector<double> radii = fill.radius;
  for (const Inlet& inlet : inlets) radii.insert(radii.end(), inlet.radius.begin(), inlet.radius.end());
  spheres_ = radii.size();
  if (spheres_ == 0)
    throw Error(ErrorCode::scene, "no sphere is there at the start, and none comes in before end_time",
                "dem.particles", "add a group, or let an inlet start earlier");
  // This check comes before all work that takes time.
  if (const std::uint64_t size = protocol::size_of_particles_frame(spheres_, scene_.output.needs_contacts());
      scene_.output.particles && size > protocol::max_payload)
    throw Error(
        ErrorCode::resource,
        fmt::format("a frame of {} spheres has {:.2f} GB; messages end at {:.2f} GB", spheres_,
                    static_cast<double>(size) / 1e9, static_cast<double>(protocol::max_payload) / 1e9),
        "output.particles", "leave spheres out of frames (\"output\": {\"particles\": false}), or use fewer");
  const double largest = *std::max_element(radii.begin(), radii.end());
  const SkinRange skins = skins_of(*scene_.dem, radii);
  const SizeLevels levels = make_size_levels(
      scene_.dem->domain, periods_for_spheres(*scene_.dem, largest, skins.largest), radii, skins, 0);
  std::vector<double> finest;
  std::ranges::copy_if(radii, std::back_inserter(finest),
                       [&](double r) { return r <= levels.largest_of_finest; });
  if (const std::string sentence =
          warn_of_full_cells(levels.finest[0], scene_.dem->domain,
                             2 * levels.largest_of_finest + std::min(skins.usual, skins.largest), finest);
      !sentence.empty())
    warn(sentence);
  expect_single_images(fixed, *scene_.dem, largest);
  surface_ = make_surface(scene_, configuration.meshes, largest + skins.largest, fixed);
  for (const std::string& sentence : warn_of_walls_at_periodic_faces(surface_, scene_, largest))
    warn(sentence);
  StartRelaxation relaxed;
  if (scene_.dem->relax_start) relaxed = relax_start(fill, surface_, scene_);
  check_start(fill, surface_, scene_, configuration.threads);
  if (relaxed.moved > 0)
    warn(fmt::format(
        "{} spheres were moved apart at the start, by at most {:.3g} m: the worst overlap was {:.3g} of the "
        "smaller radius",
        relaxed.moved, relaxed.largest_move, relaxed.worst));
  const std::size_t present = fill.position.size();
  append_waiting(inlets, scene_, fill);
  check_speeds(fill, *scene_.dem, largest_speed);
  check_spins(fill, *scene_.dem, largest_speed);
  Spheres spheres = to_spheres(fill);
  spheres.waiting = spheres.size() - present;
  traffic_ = Traffic(scene_, inlets, static_cast<std::uint32_t>(present));
  belts_ = Belts(scene_, surface_);
  choose_micro_step(spheres, fill);

  for (std::size_t b = 0; b < surface_.boundary_bodies.size(); ++b) {
    const BodyId body = surface_.boundary_bodies[b];
    bodies_.push_back({body, scene_.body_name(body), surface_.body_extent[b]});
  }
  memory_.bodies.resize(bodies_.size());
  memory_.traffic = traffic_.no_counts();
  memory_.belts = belts_.no_records();
  std::vector<BodyId> with_walls;
  for (const BoundaryBody& body : bodies_) with_walls.push_back(body.body);
  sensors_ = Sensors(scene_, with_walls, plan_wall_rows(scene_, surface_).of_sensor);
  memory_.sensors = sensors_.no_flows();

  if (ranks_ != nullptr) expect_ranks();
  choice_ = choose_engine(scene_, ranks_ != nullptr ? backend_of_ranks(configuration.backend)
                                                    : choose_backend(configuration.backend));
  if (ranks_ != nullptr && choice_.backend == Backend::cuda)
    if (const std::string sentence = warn_of_few_spheres(spheres_, ranks_->size()); !sentence.empty())
      warn(sentence);
  if (!fixed.empty())
    choice_.left_out.push_back(
        fmt::format("spheres that never move: {} fixed ones are walls of the ground", fixed.size()));
  EngineSetup setup{scene_, surface_, spheres, skins, configuration.threads};
  setup.steps = static_cast<std::uint32_t>(steps_in(longest_window()));
  setup.ranks = ranks_;
  const std::size_t predicted = check_memory(setup, levels.cells() * sizeof(std::uint32_t));
  engine_ = make_engine(choice_, setup);
  if (const double limit = engine_->speed_limit(step_taken()); limit < largest_speed)
    check_speeds(fill, *scene_.dem, limit, R"(, a shorter dem.micro_step, or "precision": "double")");
  const std::string device = device_name(choice_.backend);
  log::info("{} spheres on {} ({}), variant {}, micro step {:.4g} s, {:.1f} MB", spheres_,
            choice_.backend == Backend::cuda ? "cuda" : "cpu", device, choice_.variant, step_taken(),
            static_cast<double>(engine_->memory_bytes()) / 1e6);
  if (choice_.generic_fallback && !scene_.dem->force_generic)
    log::info("no special variant for this law, precision, domain and outputs: the generic one runs");
  for (const std::string& what : choice_.left_out) log::info("left out: {}", what);

  protocol::DemFacts facts;
  facts.backend = choice_.backend == Backend::cuda ? "cuda" : "cpu";
  facts.device = device;
  facts.precision = precision_name();
  facts.variant = choice_.variant;
  facts.left_out = choice_.left_out;
  facts.spheres = spheres_;
  facts.micro_step = step_taken();
  facts.steps_per_window = static_cast<std::uint64_t>(steps_in(scene_.coupling.window));
  if (std::isfinite(critical_)) facts.critical_time = critical_;
  facts.warnings = warnings_;  // also here, since a run that fails requests no report
  facts.predicted_memory = static_cast<double>(predicted) / 1e6;
  nlohmann::ordered_json others;
  if (ranks_ != nullptr) others["ranks"] = ranks_->size();
  if (scene_.dem->relax_start)
    others["start_relaxation"] = {{"moved", relaxed.moved},
                                  {"largest_move_m", relaxed.largest_move},
                                  {"worst_overlap", relaxed.worst},
                                  {"sweeps", relaxed.sweeps}};
  others["micro_step_by"] = scene_.dem->micro_step  ? "scene"
                            : scene_.dem->auto_step ? "auto"
                                                    : "critical time";
  if (std::isfinite(collision_)) others["collision_time_s"] = collision_;
  others["largest_skin_m"] = skins.largest;
  others["dem_setup_seconds"] =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return {{}, protocol::encode_facts(facts, others), measure_at_start()};
}

std::vector<double> Solver::measure_at_start() {
  if (!sensors_.any()) return {};
  poses_.clear();
  for (const BoundaryBody& boundary : bodies_) poses_.push_back(pose_at_start(boundary.body, scene_));
  return sensors_.measure(*engine_, poses_, 0, {}, memory_.sensors);
}

std::string Solver::precision_name() const {
  return scene_.dem->precision == scene::Precision::mixed ? "mixed" : "double";
}

// Of all ranks: a GPU for each, or the cores of their hosts. Collective. Error{usage} where there are fewer
// GPUs.
Backend Solver::backend_of_ranks(const std::string& wanted) const {
  if (wanted != "auto" && wanted != "cuda") return choose_backend(wanted);
  const unsigned devices = cuda_built() ? particles::cuda_devices() : 0, here = ranks_->on_this_host();
  std::uint64_t lacking[] = {here > devices ? 1u : 0u};
  ranks_->maximum(lacking);
  if (lacking[0] == 0) {
    particles::use_cuda_device(ranks_->place_on_host());
    return Backend::cuda;
  }
  if (wanted == "cuda")
    throw Error(ErrorCode::usage,
                fmt::format("each rank needs a CUDA device: {} on this host, and {} devices{}", here, devices,
                            cuda_built() ? "" : ", since this build has no CUDA"),
                "--ranks", "give --ranks the number of devices, or --backend cpu");
  return Backend::cpu;
}

// Error{usage} where ranks cannot compute this scene, or would only wait for each other.
void Solver::expect_ranks() const {
  const auto refuse = [](const std::string& problem, const std::string& remedy) {
    throw Error(ErrorCode::usage, problem, "--ranks", remedy);
  };
  constexpr std::size_t fewest = 50;  // spheres of a rank
  const std::size_t most = spheres_ / fewest;
  if (ranks_->size() > std::max<std::size_t>(1, most))
    refuse(fmt::format("{} spheres are too few for {} ranks", spheres_, ranks_->size()),
           most > 1 ? fmt::format("use at most {}, {} spheres each", most, fewest)
                    : "leave --ranks out: one process is faster");
}

// Checks the memory of the engine before anything is allocated.
std::size_t Solver::check_memory(const EngineSetup& given, std::size_t cells) {
  EngineSetup setup = given;
  // Ranks that share the memory of the host; each has a device of its own.
  const std::size_t here = ranks_ != nullptr && choice_.backend == Backend::cpu ? ranks_->on_this_host() : 1;
  const auto share_of = [this](std::size_t spheres) {
    return ranks_ != nullptr ? std::max<std::size_t>(1, spheres / ranks_->size()) : spheres;
  };
  if (ranks_ != nullptr) setup.indices = share_of(spheres_ - setup.spheres.waiting);
  const scene::Coupling& how = scene_.coupling;
  // The copy for a window that is taken back. The frame at the start needs one too, where it has contacts.
  const bool with_copy = (scene_.mbd && (how.adaptive || how.scheme == scene::Scheme::implicit)) ||
                         scene_.output.evaluates_contacts();
  MemoryNeed need;
  need.bytes = here * predicted_bytes(choice_, setup, with_copy);
  need.spheres = here * share_of(spheres_ - setup.spheres.waiting);
  need.cells = here * cells;
  need.where = choice_.backend == Backend::cuda ? "device" : "host";
  const std::size_t available = available_memory(choice_.backend);
  if (need.bytes > available) {
    EngineSetup one_step = setup;
    one_step.steps = 1;
    need.window = need.bytes - here * predicted_bytes(choice_, one_step, with_copy);
  }
  expect_memory(need, available);
  if (setup.spheres.waiting == 0) return need.bytes;
  EngineSetup at_once = setup;
  at_once.indices = share_of(spheres_);
  need.bytes = here * predicted_bytes(choice_, at_once, with_copy);
  if (need.bytes > available)
    warn(fmt::format(
        "with all {} spheres of its inlets there at once the run would need {:.4g} GB of {} memory, and "
        "{:.4g} GB are free: it may end for want of memory unless outlets take them out in time",
        setup.spheres.waiting, static_cast<double>(need.bytes) / 1e9, need.where,
        static_cast<double>(available) / 1e9));
  return need.bytes;
}

void Solver::warn(const std::string& sentence) {
  log::warn("{}", sentence);
  warnings_.push_back(sentence);
}

// Error{scene} where the longest window has too many micro steps. `chosen_for` explains the choice of the
// step.
void Solver::expect_steps(const std::string& chosen_for, const std::string& remedy) const {
  const double window = longest_window(), steps = steps_in(window);
  if (steps <= most_steps) return;
  throw Error(ErrorCode::scene,
              fmt::format("the micro step of {:.4g} s{} cuts the window of {:.4g} s into {:.4g} steps, more "
                          "than {:.0f}",
                          largest_step_, chosen_for, window, steps, most_steps),
              "dem.micro_step",
              remedy + (scene_.coupling.adaptive ? ", or shorten coupling.adaptive.max_window"
                                                 : ", or shorten coupling.window"));
}

void Solver::choose_micro_step(const Spheres& spheres, const Fill& fill) {
  const scene::Dem& dem = *scene_.dem;
  double critical = std::numeric_limits<double>::infinity();
  std::size_t shortest_of = 0;  // the sphere whose time that is
  for (std::uint32_t m = 0; m < dem.materials.size(); ++m) {
    double smallest = std::numeric_limits<double>::infinity();
    std::size_t sphere = 0;
    for (std::size_t i = 0; i < spheres.size(); ++i)
      if (spheres.material[i] == m && spheres.radius[i] < smallest) smallest = spheres.radius[i], sphere = i;
    if (!std::isfinite(smallest)) continue;
    const double time = critical_time(dem, MaterialId{m}, smallest);
    if (time < critical) critical = time, shortest_of = sphere;
  }
  critical_ = critical;
  watch_ = LimitWatch(dem, spheres);
  const double speed = std::max(watch_.expected_speed(spheres, scene_.gravity),
                                belts_.any() ? belts_.largest_speed(scene_.end_time) : 0.0);
  collision_ = watch_.collision_time(speed);
  double chosen = automatic_step_share * critical;
  const double crossing = watch_.crossing_time(speed);
  if (dem.auto_step)
    chosen = std::min({chosen, automatic_collision_share * collision_, automatic_travel_share * crossing});
  largest_step_ = dem.micro_step.value_or(chosen);
  if (largest_step_ > largest_step_share * critical)
    throw Error(
        ErrorCode::scene,
        fmt::format("the micro step is {:.4g} s, above {:.4g} s, the limit for the smallest sphere",
                    largest_step_, largest_step_share * critical),
        "dem.micro_step",
        fmt::format("use at most that, or leave it out for {:.4g} s", automatic_step_share * critical));
  if (dem.micro_step)
    expect_steps("", "enlarge it");
  else if (largest_step_ < automatic_step_share * critical)
    expect_steps(fmt::format(", chosen for a collision at {:.3g} m/s,", speed),
                 "give one, or make the spheres slower or the domain smaller");
  else
    expect_steps(fmt::format(", chosen for a sphere of radius {:.4g} m of '{}',", spheres.radius[shortest_of],
                             dem.particles[fill.group[shortest_of]].name),
                 "enlarge that radius, or leave the sphere out");
  const double window = scene_.coupling.window, steps = steps_in(window);
  log::info(
      "micro step {:.4g} s{}: {} in a window of {:.4g} s; critical time {:.4g} s, fastest collision to "
      "expect "
      "{:.4g} s at {:.3g} m/s",
      window / steps, dem.micro_step ? "" : " (chosen)", steps, window, critical, collision_, speed);
  // The checks apply to the step that is taken: the requested one may be longer than the window.
  const double taken = step_taken(),
               advised = std::min(automatic_collision_share * collision_, automatic_travel_share * crossing);
  if (taken > largest_collision_share * collision_)
    warn(fmt::format(
        "a collision at {:.3g} m/s, which a fall through the domain gives, takes {:.3g} s, {:.2g} micro "
        "steps: use dem.micro_step = {:.3g}, or \"auto\"",
        speed, collision_, collision_ / taken, advised));
  if (taken > largest_travel_share * crossing)
    warn(fmt::format(
        "a sphere of {:.3g} m/s, which the start or a fall through the domain gives, goes {:.3g} m in a "
        "micro "
        "step of {:.3g} s and may pass others or walls unseen, the smallest radius being {:.3g} m: use "
        "dem.micro_step = {:.3g}, or \"auto\"",
        speed, speed * taken, taken, speed * crossing, advised));
}

}  // namespace tandem::dem
