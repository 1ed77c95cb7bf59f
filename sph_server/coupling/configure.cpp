// Builds the liquid of a scene before the first window.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/scene/no_solver_options.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/plain_text.hpp"
#include "particles/base/backend.hpp"
#include "particles/base/memory.hpp"
#include "protocol/codec.hpp"
#include "protocol/facts.hpp"
#include "protocol/frame.hpp"
#include "protocol/start_files.hpp"
#include "sph_server/coupling/load_solver.hpp"
#include "sph_server/coupling/response.hpp"
#include "sph_server/equations/time_step.hpp"

namespace tandem::sph {

// Checks the memory of the engine before its particles are placed [bytes].
std::size_t Solver::check_memory(const LiquidStart& start) const {
  const scene::Coupling& how = scene_.coupling;
  const bool with_copy = scene_.mbd && (how.adaptive || how.scheme == scene::Scheme::implicit);
  const std::size_t count = start.particles() +
                            Traffic(*scene_.sph, start.inlets, start.setup).to_come(scene_.end_time),
                    bytes =
                        predicted_bytes(count, start.setup,
                                        scene_.sph->precision == scene::LiquidPrecision::mixed, with_copy),
                    available = particles::available_memory(start.setup.backend);
  if (bytes > available)
    throw Error(ErrorCode::resource,
                fmt::format("the {} particles of the liquid need {:.4g} GB; {:.4g} GB are free", count,
                            static_cast<double>(bytes) / 1e9, static_cast<double>(available) / 1e9),
                start.setup.backend == particles::Backend::cuda ? "device memory" : "host memory",
                "give a larger sph.spacing");
  return bytes;
}

std::uint64_t Solver::steps_of(double window) const {
  return std::max(least_steps_, static_cast<std::uint64_t>(std::ceil(window / step_at_rest() * (1 - 1e-12))));
}

double Solver::most_passed(const LiquidStart& start, double window) const {
  double most = 0;
  for (const BodyWalls& walls : start.walls) {
    if (walls.body == ground) continue;
    const scene::Body& body = scene_.mbd->bodies[walls.body.value];
    double area = 0, extent2 = 0;
    for (const auto& t : walls.mesh.triangles) {
      const auto& v = walls.mesh.vertices;
      area += 0.5 * norm(cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]));
    }
    for (const Vec3d& vertex : walls.mesh.vertices) extent2 = std::max(extent2, norm2(vertex));
    const double gyration2 = (body.inertia[0] + body.inertia[1] + body.inertia[2]) / (2 * body.mass);
    most = std::max(most, properties_.density * properties_.sound_speed * area * window / body.mass *
                              std::max(1.0, extent2 / gyration2));
  }
  return most;
}

// Where the load answers within a window matters only for bodies that pass a good part of their momentum to
// the liquid in it.
void Solver::measure_responses(const LiquidStart& start, const LiquidState& liquid) {
  constexpr double negligible = 0.05;
  constexpr double enough_steps = 6;  // of a window, for the impulse of its path to act in it
  constexpr double fewest = 12, most = 64;
  if (!scene_.mbd) return;
  const scene::Coupling& how = scene_.coupling;
  const double window = how.adaptive ? how.adaptive->max_window : how.window;
  if (most_passed(start, window) < negligible) return;
  if (how.scheme == scene::Scheme::implicit) least_steps_ = static_cast<std::uint64_t>(enough_steps);
  const StepFigures figures = engine_->figures();
  const double stable =
      0.8 * step_limits(properties_, figures.largest_speed, figures.largest_acceleration).smallest;
  const double steps = std::ceil(window / std::min(window / static_cast<double>(steps_of(window)), stable)),
               dt = window / steps;
  std::vector<BodyId> body_of;
  for (const particles::BoundaryBody& body : bodies_) body_of.push_back(body.body);
  responses_ = sph::measure_responses(*engine_, liquid, start.poses, body_of, scene_, properties_.sound_speed,
                                      dt, static_cast<int>(std::clamp(3 * steps, fewest, most)));
}

const protocol::TangentSet& Solver::linearise() {
  tangents_.time = Nanoseconds{memory_.now};
  tangents_.responses = responses_;
  for (protocol::BodyResponse& response : tangents_.responses) {
    const auto wall = std::ranges::find(bodies_, BodyId{response.body}, &particles::BoundaryBody::body);
    const Mat3d now = engine_->poses()[static_cast<std::size_t>(wall - bodies_.begin())].R,
                before = start_poses_[static_cast<std::size_t>(wall - bodies_.begin())].R;
    turn(now, before, response);
  }
  return tangents_;
}

protocol::Configured Solver::configure(const protocol::Configuration& configuration) {
  const auto begin = std::chrono::steady_clock::now();
  scene_ = scene::parse(configuration.scene_text, configuration.origin);
  scene::expect_masses(scene_, configuration.origin);
  if (!scene_.sph)
    throw Error(ErrorCode::scene, "has no 'sph'", configuration.origin, "no sph_server is needed");
  scene::expect_no_solver_options(scene_.sph->solver_options, configuration.origin, "sph", "sph_server");
  const particles::Backend backend = particles::choose_backend(configuration.backend);
  const scene::Sph& sph = *scene_.sph;
  if (!sph.domain_is_given)
    throw Error(ErrorCode::scene, "has no 'min' and 'max'", configuration.origin + ": sph.domain",
                "the coordinator gives them where a scene does not");
  const scene::Liquid& liquid = sph.liquids.front();

  LiquidStart start = prepare_start(scene_, configuration.meshes);
  start.setup.backend = backend;
  start.setup.threads = configuration.threads;
  const std::vector<BodyWalls>& walls = start.walls;
  properties_ = start.setup.liquid;
  vessel_ = start.setup.vessel;
  follows_ = start.setup.follows;
  follows_from_ = start.setup.follows_from;
  for (const BodyWalls& body : walls) {
    double extent = 0;
    for (const Vec3d& vertex : body.mesh.vertices) extent = std::max(extent, norm(vertex));
    const bool is_new = bodies_.empty() || bodies_.back().body != body.body;
    bodies_loaded_ += is_new ? 1 : 0;
    load_of_.push_back(bodies_loaded_ - 1);
    bodies_.push_back({body.body, scene_.body_name(body.body), extent});
    corners_.push_back(body.mesh.vertices);
    for (const std::string& sentence : body.approximations) log::info("{}", sentence);
  }
  traffic_ = Traffic(sph, start.inlets, start.setup);
  passed_ = traffic_.no_counts();
  for (const Inlet& inlet : start.inlets) {
    if (bodies_.empty() || bodies_.back().body != ground) ++bodies_loaded_;
    load_of_.push_back(bodies_loaded_ - 1);
    bodies_.push_back({ground, scene_.body_name(ground), norm(inlet.of.pose.p_WB)});
    corners_.emplace_back();
  }
  const double window =
      scene_.coupling.adaptive ? scene_.coupling.adaptive->max_window : scene_.coupling.window;
  if (const double steps = window / step_at_rest(); steps > most_steps)
    throw Error(
        ErrorCode::scene,
        fmt::format("the step of {:.4g} s cuts the window of {:.4g} s into {:.4g} steps, more than {:.0f}",
                    step_at_rest(), window, steps, most_steps),
        sph.micro_step ? "sph.micro_step" : "sph.spacing", "enlarge it, or shorten the window");
  for (const std::string& sentence : start.warnings) warn(sentence);
  const std::size_t predicted = check_memory(start);
  LiquidState liquid_now = particles_of(start, scene_, places_in(configuration.files));
  if (const auto poses = protocol::start_poses(configuration.files); !poses.empty())
    if (const auto warning = move_to(poses, scene_, start, liquid_now)) warn(*warning);
  start_poses_ = start.poses;
  at_start_ = static_cast<std::uint32_t>(liquid_now.size());
  id_.resize(at_start_);
  std::iota(id_.begin(), id_.end(), 0u);
  if (const std::uint64_t size =
          protocol::size_of_particles_frame(at_start_ + traffic_.to_come(scene_.end_time), true);
      scene_.output.particles && size > protocol::max_payload)
    throw Error(
        ErrorCode::resource,
        fmt::format("a frame of {} particles has {:.2f} GB; messages end at {:.2f} GB",
                    at_start_ + traffic_.to_come(scene_.end_time), static_cast<double>(size) / 1e9,
                    static_cast<double>(protocol::max_payload) / 1e9),
        "output.particles",
        "leave particles out of frames (\"output\": {\"particles\": false}), or use a larger spacing");
  engine_ = make_liquid_engine(start.setup, sph.precision == scene::LiquidPrecision::mixed);
  engine_->set_state(liquid_now, start.poses);
  measure_responses(start, liquid_now);
  sensors_ = Sensors(scene_, start.setup, walls);
  flows_ = sensors_.no_flows();
  const EnergyBalance energies = engine_->energies();
  memory_.energy_start = energies.kinetic + energies.compression;
  memory_.energy_scale = memory_.energy_start;

  protocol::SphFacts facts;
  facts.particles = id_.size();
  facts.backend = backend == particles::Backend::cuda ? "cuda" : "cpu";
  facts.device = particles::device_name(backend);
  facts.precision = precision_name();
  facts.predicted_memory = static_cast<double>(predicted) / 1e6;
  std::vector<std::string>& left_out = facts.left_out.emplace();
  if (properties_.viscosity == 0 && properties_.artificial == 0)
    left_out.emplace_back("viscosity of the liquid: it has none");
  left_out.emplace_back("surface tension of the liquid");
  left_out.insert(left_out.end(), start.coarsened.begin(), start.coarsened.end());
  if (scene_.dem)
    left_out.emplace_back("forces between grains and liquid: each is as if the other was not there");
  facts.sound_speed = properties_.sound_speed;
  facts.longest_step = step_at_rest();
  facts.steps_per_window = steps_of(scene_.coupling.window);
  facts.wall_facets.emplace();
  for (const TriangleMesh& mesh : start.setup.walls) *facts.wall_facets += mesh.triangles.size();
  const StartCost cost = engine_->start_cost();
  facts.beside_walls = cost.beside_walls;
  facts.rates_seconds = cost.rates_seconds;
  facts.warnings = warnings_;  // also here, since a run that fails requests no report
  nlohmann::ordered_json others;
  others["spacing_m"] = properties_.spacing;
  others["mass_kg"] = mass();
  others["depth_m"] = start.depth;
  others["vessel"] = scene_.body_name(start.vessel);
  others["sound_speed_by"] = liquid.sound_speed ? "scene" : "rule";
  others["setup_seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  log::info(
      "{} particles of '{}' on {} ({}), spacing {:.4g} m, speed of sound {:.4g} m/s, step {:.4g} s: {} in a "
      "window",
      id_.size(), liquid.name, *facts.backend, *facts.device, properties_.spacing, properties_.sound_speed,
      step_at_rest(), *facts.steps_per_window);
  for (const std::string& what : left_out) log::info("left out: {}", what);
  std::vector<double> measured;
  if (sensors_.any()) measured = sensors_.measure(*engine_, 0, flows_);
  return {{}, protocol::encode_facts(facts, others), measured};
}

}  // namespace tandem::sph
