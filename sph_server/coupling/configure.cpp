// Builds the liquid of a scene before the first window.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/scene/no_solver_options.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/plain_text.hpp"
#include "particles/base/backend.hpp"
#include "protocol/codec.hpp"
#include "protocol/facts.hpp"
#include "protocol/frame.hpp"
#include "sph_server/coupling/load_solver.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/io/check_start.hpp"

namespace tandem::sph {
namespace {

dem::Periods periods_of(const scene::Sph& sph) {
  dem::Periods periods;
  periods.min = sph.domain.min;
  for (int a = 0; a < 3; ++a)
    if (sph.periodic[static_cast<std::size_t>(a)]) periods.length[a] = sph.domain.max[a] - sph.domain.min[a];
  return periods;
}

Liquid properties_of(const scene::Sph& sph, Vec3d gravity, double depth) {
  const scene::Liquid& given = sph.liquids.front();
  Liquid liquid;
  liquid.density = given.density;
  liquid.viscosity = given.viscosity;
  liquid.spacing = sph.spacing;
  liquid.artificial = given.artificial_viscosity;
  liquid.gravity = gravity;
  liquid.sound_speed =
      given.sound_speed.value_or(suggested_sound_speed(given.expected_speed, norm(gravity), depth));
  return liquid;
}

}  // namespace

protocol::Configured Solver::configure(const protocol::Configuration& configuration) {
  const auto begin = std::chrono::steady_clock::now();
  scene_ = scene::parse(configuration.scene_text, configuration.origin);
  scene::expect_masses(scene_, configuration.origin);
  if (!scene_.sph)
    throw Error(ErrorCode::scene, "has no 'sph'", configuration.origin, "no sph_server is needed");
  scene::expect_no_solver_options(scene_.sph->solver_options, configuration.origin, "sph", "sph_server");
  if (configuration.backend == "cuda" && !scene_.dem)
    throw Error(ErrorCode::resource, "sph_server computes on the CPU only", "--backend",
                "give --backend cpu");
  const scene::Sph& sph = *scene_.sph;
  const scene::Liquid& liquid = sph.liquids.front();

  const Sites sites = sites_of(liquid, sph.spacing, scene_.gravity);
  particles_ = sites.position.size();
  if (const std::uint64_t size = protocol::size_of_particles_frame(particles_, true);
      scene_.output.particles && size > protocol::max_payload)
    throw Error(
        ErrorCode::resource,
        fmt::format("a frame of {} particles has {:.2f} GB; messages end at {:.2f} GB", particles_,
                    static_cast<double>(size) / 1e9, static_cast<double>(protocol::max_payload) / 1e9),
        "output.particles",
        "leave particles out of frames (\"output\": {\"particles\": false}), or use a larger spacing");
  properties_ = properties_of(sph, scene_.gravity, sites.deepest());
  const std::vector<BodyWalls> walls = walls_of_bodies(scene_, configuration.meshes);
  std::vector<dem::BodyPose> poses;
  LiquidSetup setup;
  for (const BodyWalls& body : walls) {
    bodies_.push_back({body.body, scene_.body_name(body.body), 0});
    poses.push_back(dem::pose_at_start(body.body, scene_));
    setup.walls.push_back(body.mesh);
    for (const std::string& sentence : body.inside) log::info("{}", sentence);
  }
  check_start(sites, scene_, walls, poses);

  setup.liquid = properties_;
  setup.domain = sph.domain;
  setup.periods = periods_of(sph);
  setup.slip.assign(walls.size(), sph.wall_friction == scene::WallFriction::free_slip);
  setup.threads = configuration.threads;
  const double window =
      scene_.coupling.adaptive ? scene_.coupling.adaptive->max_window : scene_.coupling.window;
  if (const double steps = window / step_at_rest(); steps > most_steps)
    throw Error(
        ErrorCode::scene,
        fmt::format("the step of {:.4g} s cuts the window of {:.4g} s into {:.4g} steps, more than {:.0f}",
                    step_at_rest(), window, steps, most_steps),
        sph.micro_step ? "sph.micro_step" : "sph.spacing", "enlarge it, or shorten the window");
  engine_ = make_liquid_engine(setup, sph.precision == scene::LiquidPrecision::mixed);
  engine_->set_state(fill_of(sites, liquid, properties_), poses);
  const EnergyBalance energies = engine_->energies();
  memory_.energy_start = energies.kinetic + energies.compression;
  memory_.energy_scale = memory_.energy_start;

  protocol::SphFacts facts;
  facts.particles = particles_;
  facts.backend = "cpu";
  facts.device = dem::device_name(dem::Backend::cpu);
  facts.precision = precision_name();
  std::vector<std::string>& left_out = facts.left_out.emplace();
  if (properties_.viscosity == 0 && properties_.artificial == 0)
    left_out.emplace_back("viscosity of the liquid: it has none");
  left_out.emplace_back("surface tension of the liquid");
  if (scene_.dem)
    left_out.emplace_back("forces between grains and liquid: each is as if the other was not there");
  facts.sound_speed = properties_.sound_speed;
  facts.longest_step = step_at_rest();
  facts.steps_per_window =
      static_cast<std::uint64_t>(std::ceil(scene_.coupling.window / step_at_rest() * (1 - 1e-12)));
  facts.warnings = warnings_;  // also here, since a run that fails requests no report
  nlohmann::ordered_json others;
  others["spacing_m"] = properties_.spacing;
  others["mass_kg"] = static_cast<double>(particles_) * properties_.mass();
  others["depth_m"] = sites.deepest();
  others["sound_speed_by"] = liquid.sound_speed ? "scene" : "rule";
  others["setup_seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  log::info(
      "{} particles of '{}' on cpu ({}), spacing {:.4g} m, speed of sound {:.4g} m/s, step {:.4g} s: {} in a "
      "window",
      particles_, liquid.name, *facts.device, properties_.spacing, properties_.sound_speed, step_at_rest(),
      *facts.steps_per_window);
  for (const std::string& what : left_out) log::info("left out: {}", what);
  return {{}, protocol::encode_facts(facts, others), {}};
}

}  // namespace tandem::sph
