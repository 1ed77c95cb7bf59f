#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/verdict/figures.hpp"
#include "coordinator/verdict/rules.hpp"
#include "coordinator/verdict/wall_watch.hpp"
#include "dem_server/laws/step_limits.hpp"
#include "dem_server/laws/stiffer.hpp"

namespace tandem::launch {
namespace {

// The longest micro step [s], 0 where none is known: what the participant reports and what its accounts have.
double micro_step_of(const RunFigures& run) {
  return std::max(run.facts.dem.micro_step.value_or(0), run.number("largest_micro_step_s").value_or(0));
}

// The shortest critical time [s], infinite where none is known: of the participant and of the scene's
// spheres.
double critical_time_of(const RunFigures& run) {
  constexpr double none = std::numeric_limits<double>::infinity();
  return std::min(run.facts.dem.critical_time.value_or(none),
                  run.number("critical_time_of_scene_s").value_or(none));
}

// Warnings that a mesh may have another unit: lost spheres may have passed through it.
std::string doubtful_units(const RunFigures& run) {
  std::string text;
  const auto warnings = run.summary.find("warnings");
  if (warnings != run.summary.end())
    for (const Json& warning : *warnings)
      if (warning.is_string() && warning.get<std::string>().find("then give \"scale\"") != std::string::npos)
        text += "; " + warning.get<std::string>();
  return text;
}

std::string of_crossing(const Json& c) {
  return fmt::format("wall '{}' of '{}' and wall '{}' of '{}'", c.value("wall_a", ""), c.value("body_a", ""),
                     c.value("wall_b", ""), c.value("body_b", ""));
}

}  // namespace

void add_particle_rules(std::vector<Rule>& table) {
  table.push_back(
      {"overlap", "max_overlap_ratio", 0.05,
       "contact laws are valid for overlaps of a few per cent of the radius; the limit is "
       "`dem.overlap_limit` of the scene",
       "the modulus that brings the overlap below the limit",
       [](const scene::Scene& scene) { return scene.dem.value().overlap_limit; },
       [](const RunFigures& run) -> Figures {
         return run.scene.dem ? of_run(run.number("max_overlap_ratio")) : std::nullopt;
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "the largest overlap is {:.2g} of the smaller radius (limit dem.overlap_limit = {:.2g}): "
             "use {}; the micro step becomes {:.2g} of what it is",
             f.value, limit, dem::stiffer(*run.scene.dem, limit / f.value),
             dem::step_of_stiffer(*run.scene.dem, limit / f.value));
       }});
  table.push_back(
      {"speed", "max_speed", std::numeric_limits<double>::infinity(),
       "the limit is `dem.speed_limit` of the scene [m/s]; without it every speed is accepted",
       "a shorter micro step, or another limit",
       [](const scene::Scene& scene) { return scene.dem.value().speed_limit.value(); },
       [](const RunFigures& run) -> Figures {
         return run.scene.dem && run.scene.dem->speed_limit ? of_run(run.facts.dem.max_speed) : std::nullopt;
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "the fastest sphere has {:.4g} m/s (limit dem.speed_limit = {:.4g}): use dem.micro_step = "
             "{:.2g} s (now {:.2g}), or a higher limit if such speeds are meant",
             f.value, limit, 0.5 * run.facts.dem.micro_step.value_or(0),
             run.facts.dem.micro_step.value_or(0));
       }});
  table.push_back(
      {"lost", "lost_particles / spheres", 0.001,
       "spheres that leave `dem.domain` are removed; where they are meant to leave, use an outlet",
       "a larger domain, an outlet, or the scale of a mesh", nullptr,
       [](const RunFigures& run) -> Figures {
         return run.facts.dem.spheres.value_or(0) > 0
                    ? share(run.number("lost_particles"), run.facts.dem.spheres)
                    : std::nullopt;
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "{:.0f} of {} spheres left the domain, a share of {:.2g} (limit {:.2g}): use a larger "
             "dem.domain, or dem.outlets where they are meant to leave{}",
             run.number("lost_particles").value_or(0), run.facts.dem.spheres.value_or(0), f.value, limit,
             doubtful_units(run));
       }});
  table.push_back(
      {"momentum", "momentum_balance", 1e-6,
       "the momentum balance of the particles with gravity and walls closes up to the rounding of their "
       "stored state, at most 1e-8",
       "precision `double`, or a participant that records all forces", nullptr,
       [](const RunFigures& run) { return of_run(run.number("momentum_balance")); },
       [](const RunFigures&, const Figure& f, double limit) {
         return fmt::format(
             "the momentum of the particles is off by {:.2g} of what acts on them (limit {:.0e}): use "
             "\"precision\": \"double\", or a particle participant that records all forces of walls "
             "(docs/protocol.md)",
             f.value, limit);
       }});
  table.push_back(
      {"collision_steps", "windows_of_too_long_steps / windows", 0.01,
       "share of the windows in which a collision of the fastest spheres would take fewer than six micro "
       "steps, which loses 1 % of its speed, or in which spheres could pass through each other undetected",
       "the micro step that the fastest collision requires", nullptr,
       [](const RunFigures& run) {
         return share(run.facts.dem.windows_of_too_long_steps, run.number("windows"));
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         const auto advised = run.facts.dem.advised_micro_step;
         return fmt::format(
             "the micro step is too long for the fastest spheres in {:.2g} of the windows (limit "
             "{:.2g}): use dem.micro_step = {}",
             f.value, limit,
             advised ? fmt::format("{:.2g} s (now {:.2g})", *advised, run.facts.dem.micro_step.value_or(0))
                     : "\"auto\"");
       }});
  table.push_back(
      {"critical_step",
       "max(micro_step_s, largest_micro_step_s) / min(critical_time_s, critical_time_of_scene_s)",
       dem::largest_step_share,
       "a sphere in a packing has up to twelve contacts, which halves the limit of stability of a single "
       "contact; damping lowers it further",
       "a fifth of the critical time", nullptr,
       [](const RunFigures& run) -> Figures {
         const double step = micro_step_of(run), critical = critical_time_of(run);
         return step > 0 && std::isfinite(critical) ? of_run(step / critical) : std::nullopt;
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "the micro step is {:.2g} of the critical time (limit {:.2g}): use dem.micro_step = {:.2g} "
             "s (now {:.2g}), or leave it out",
             f.value, limit, dem::automatic_step_share * critical_time_of(run), micro_step_of(run));
       }});
  table.push_back(
      {"body_contact", "wall_crossings[].share", wall_depth_share,
       "walls act on spheres only: walls of different bodies that overlap by more than 1 % of the thinner "
       "one "
       "have passed through each other",
       "`shapes` of the bodies with `\"use\": \"contact\"`, a joint with `limits`, or a bushing between them",
       nullptr, [](const RunFigures& run) { return figures_of(run, "wall_crossings", "share", of_crossing); },
       [](const RunFigures& run, const Figure& f, double limit) {
         const Json& crossing = entry_of(run, "wall_crossings", f.of, of_crossing);
         return fmt::format(
             "{} pass through each other from t = {:.4g} s on, by up to {:.2g} m, {:.2g} of the thinner "
             "one (limit {:.2g}); walls act on spheres only: give the bodies shapes with \"use\": "
             "\"contact\", or "
             "put a joint with limits (stiffness and where it stops), a bushing or a spring_damper between "
             "them",
             f.of, figure_of(crossing, "time_s"), figure_of(crossing, "depth_m"), f.value, limit);
       }});
}

}  // namespace tandem::launch
