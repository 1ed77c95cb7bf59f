#include "launch/verdict/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem_server/laws/step_limits.hpp"
#include "dem_server/laws/stiffer.hpp"
#include "launch/verdict/liquid_rules.hpp"
#include "launch/verdict/wall_watch.hpp"

namespace tandem::launch {
namespace {

using Json = nlohmann::ordered_json;
using Figures = std::optional<std::vector<Figure>>;

constexpr const char* whole_run = "the run";

Figures of_run(std::optional<double> value) {
  if (!value) return std::nullopt;
  return std::vector<Figure>{{whole_run, *value}};
}

// part / whole; 0 where both are 0.
Figures share(std::optional<double> part, std::optional<double> whole) {
  if (!part || !whole) return std::nullopt;
  return of_run(*part == 0 ? 0 : std::abs(*part) / *whole);
}

std::optional<double> value_of(const std::optional<protocol::fact::Estimate>& estimate) {
  return estimate ? estimate->value : std::nullopt;
}

double length_of(const Json& vector) {
  return std::hypot(vector[0].get<double>(), vector[1].get<double>(), vector[2].get<double>());
}
// |a - b - c| of three vectors.
double open_part(const Json& a, const Json& b, const Json& c) {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double open = a[i].get<double>() - b[i].get<double>() - c[i].get<double>();
    sum += open * open;
  }
  return std::sqrt(sum);
}

// Settings of the multibody solver for an error reduced by `factor` < 1; its order is two.
std::string finer_step(const scene::Scene& scene, double factor) {
  const scene::Integrator integrator = scene.mbd ? scene.mbd->integrator : scene::Integrator{};
  factor = std::isfinite(factor) ? std::max(factor, 1e-4) : 1e-4;
  if (integrator.error_tolerance)
    return fmt::format("use mbd.integrator.error_tolerance = {:.2g} (now {:.2g})",
                       factor * *integrator.error_tolerance, *integrator.error_tolerance);
  const double step = integrator.step.value_or(scene.coupling.window);
  return fmt::format(
      "use mbd.integrator.step = {:.2g} s (now {:.2g}), or let the error choose it with "
      "mbd.integrator.error_tolerance = 1e-6",
      0.9 * std::sqrt(factor) * step, step);
}

// A number of an object of the summary; NaN where it is none, which exceeds every limit.
double figure_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>()
                                                     : std::numeric_limits<double>::quiet_NaN();
}

// ---- contradictions of a multibody participant

// A residual of all bodies of `border` that have it.
Figures residuals_of_bodies(const RunFigures& run, const char* key) {
  const auto bodies = run.summary.find("border");
  if (bodies == run.summary.end()) return std::nullopt;
  std::vector<Figure> figures;
  for (const auto& [name, body] : bodies->items())
    if (body.contains(key)) figures.push_back({fmt::format("body '{}'", name), figure_of(body, key)});
  return figures.empty() ? Figures() : figures;
}

// The shares of a list of `motion_jumps` or `frame_differences`, one per body.
Figures shares_of_bodies(const RunFigures& run, const char* key) {
  const auto found = run.summary.find(key);
  if (found == run.summary.end()) return std::nullopt;
  std::vector<Figure> figures;
  for (const Json& body : *found)
    figures.push_back({fmt::format("body '{}'", body.value("body", "")), figure_of(body, "share")});
  return figures;
}

// "0.05 m, 0 rad, 0 m/s and 0 rad/s" and the time [s] of the difference of one body of such a list.
std::pair<std::string, double> difference_of(const RunFigures& run, const char* key, const std::string& of) {
  for (const Json& body : run.summary[key])
    if (of == fmt::format("body '{}'", body.value("body", "")))
      return {fmt::format("{:.3g} m, {:.3g} rad, {:.3g} m/s and {:.3g} rad/s", figure_of(body, "position_m"),
                          figure_of(body, "rotation_rad"), figure_of(body, "velocity_m_per_s"),
                          figure_of(body, "angular_velocity_rad_per_s")),
              figure_of(body, "time_s")};
  return {};
}

// The shares of a list whose entries say what they are of.
Figures shares_of(const RunFigures& run, const char* key) {
  const auto found = run.summary.find(key);
  if (found == run.summary.end()) return std::nullopt;
  std::vector<Figure> figures;
  for (const Json& entry : *found) figures.push_back({entry.value("of", ""), figure_of(entry, "share")});
  return figures;
}
// The entry of a list of the summary that is of this.
const Json& entry_of(const RunFigures& run, const char* key, const std::string& of) {
  return *std::ranges::find_if(run.summary[key],
                               [&](const Json& entry) { return entry.value("of", "") == of; });
}

// Ten times the accuracy of the scene's data: mbd_server ends the run there.
double limit_of_joints(const scene::Scene& scene) {
  return scene.mbd ? std::max(1e-3, 10 * scene.mbd->integrator.assembly_tolerance) : 1e-3;
}

// ---- particles

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

// ---- the table

std::string limit_text(double limit) {
  return fmt::format("{:.3g}", limit);
}

std::vector<Rule> make_rules() {
  const auto fixed = static_cast<double (*)(const scene::Scene&)>(nullptr);
  std::vector<Rule> table;
  table.push_back(
      {"energy_mbd", "abs(mbd_largest_energy_balance_J) / mbd_energy_scale_J", 0.01,
       "a change of the energy of the multibody part without work of forces, motions or particles is an "
       "error of its integration; 1 % of the energy that moves shows in a plot",
       "a shorter step or a smaller error tolerance", fixed,
       [](const RunFigures& run) {
         return share(run.facts.mbd.largest_energy_balance, run.facts.mbd.energy_scale);
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "{:.3g} J of the multibody part's energy are unaccounted for, {:.2g} of what moves in "
             "it (limit {:.2g}): {}",
             run.facts.mbd.largest_energy_balance.value_or(0), f.value, limit,
             finer_step(run.scene, limit / f.value));
       }});
  table.push_back(
      {"energy_coupling", "abs(energy_residual)", 0.05,
       "energy that the coupling creates or removes, relative to the energy that bodies and particles "
       "exchange; runs of the stability gallery whose motion was right stay below 0.02, those that were "
       "wrong lie above 0.1",
       "a shorter window, or scheme `implicit`", fixed,
       [](const RunFigures& run) -> Figures {
         const auto residual = run.number("energy_residual");
         return residual ? of_run(std::abs(*residual)) : std::nullopt;
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "the coupling {} {:.2g} of the energy that bodies and particles exchange (limit {:.2g}): "
             "use coupling.window = {:.2g} s (now {:.2g}), or coupling.scheme = \"implicit\"",
             run.number("energy_residual").value_or(0) > 0 ? "made" : "took away", f.value, limit,
             std::max(0.1, 0.9 * std::sqrt(limit / f.value)) * run.scene.coupling.window,
             run.scene.coupling.window);
       }});
  table.push_back(
      {"impulse_closure", "impulse_closure", 1e-9,
       "the impulse that particles give and the one that bodies receive are equal up to rounding, which "
       "reaches 1e-12 in a million windows",
       "a participant that applies all of the load", fixed,
       [](const RunFigures& run) { return of_run(run.number("impulse_closure")); },
       [](const RunFigures& run, const Figure& f, double limit) {
         std::string who = "a body", what = "load";
         double worst = 0, given = 0, got = 0;
         const auto interface = run.summary.find("border");
         if (interface != run.summary.end())
           for (const auto& [name, body] : interface->items())
             for (const char* part : {"", "angular_"}) {
               const std::string key = std::string(part) + "impulse_";
               const Json &recorded = body.at(key + "booked"), &applied = body.at(key + "applied");
               const double open = open_part(recorded, applied, body.at(key + "outstanding")),
                            whole = length_of(recorded);
               if (!(open / std::max(whole, 1e-300) > worst)) continue;
               worst = open / std::max(whole, 1e-300), given = whole, got = length_of(applied);
               who = "body '" + name + "'", what = *part ? "N m s of torque" : "N s of force";
             }
         return fmt::format(
             "of {:.4g} {} that the particles gave {} it was moved by {:.4g}; impulse_closure is "
             "{:.2g} (limit {:.0e}): use a multibody participant that applies force and torque of "
             "every load, as mbd_server of this version does (docs/protocol.md)",
             given, what, who, got, f.value, limit);
       }});
  table.push_back({"impulse_outstanding", "impulse_outstanding", 0.1,
                   "share of the particles' load that a scheme withholds to stay stable; a body that "
                   "receives less than nine tenths of its load moves differently",
                   "a shorter window, or scheme `implicit`", fixed,
                   [](const RunFigures& run) { return of_run(run.number("impulse_outstanding")); },
                   [](const RunFigures& run, const Figure& f, double limit) {
                     return fmt::format(
                         "{:.2g} of the particles' load has not reached the bodies (limit {:.2g}): use "
                         "coupling.window = {:.2g} s (now {:.2g}), or coupling.scheme = \"implicit\"",
                         f.value, limit, std::max(0.1, 0.9 * limit / f.value) * run.scene.coupling.window,
                         run.scene.coupling.window);
                   }});
  table.push_back(
      {"window_stability", "border.BODY.omega_H / border.BODY.stable_omega_H", 2,
       "the estimate of omega H treats the grains as fixed and is an upper bound: a bed as heavy as the body "
       "or lighter lowers the true value by up to a factor of two; beyond that the motion grows",
       "the largest stable window, or a scheme that is stable with this one", fixed,
       [](const RunFigures& run) -> Figures {
         const auto interface = run.summary.find("border");
         // Adaptive windows stay below the limit; one beyond it is repeated.
         if (interface == run.summary.end() || run.scene.coupling.adaptive) return std::nullopt;
         std::vector<Figure> figures;
         for (const auto& [name, body] : interface->items())
           if (body.contains("omega_H") && body.contains("stable_omega_H"))
             figures.push_back({"body '" + name + "'",
                                body["omega_H"].get<double>() == 0
                                    ? 0
                                    : body["omega_H"].get<double>() / body["stable_omega_H"].get<double>()});
         return figures.empty() ? Figures() : figures;
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         const Json& body = run.summary["border"][f.of.substr(6, f.of.size() - 7)];
         std::string use;
         if (body.value("stable_window_s", 0.0) > 0)
           use = fmt::format("coupling.window = {:.2g} s (now {:.2g})", body["stable_window_s"].get<double>(),
                             run.scene.coupling.window);
         const std::string scheme = body.value("stable_scheme", "implicit");
         use += fmt::format("{}coupling.scheme = \"{}\"", use.empty() ? "" : ", or ", scheme);
         return fmt::format(
             "{} vibrates on its contacts with omega H = {:.3g}, {:.2g} times the limit of "
             "stability of the scheme (limit "
             "{:.2g}): use {}",
             f.of, body["omega_H"].get<double>(), f.value, limit, use);
       }});
  table.push_back(
      {"window_error", "windows_of_too_large_error / windows", 0.01,
       "share of the windows that have the shortest length allowed and an error above the tolerance",
       "a smaller `coupling.adaptive.min_window`", fixed,
       [](const RunFigures& run) {
         return share(run.number("windows_of_too_large_error"), run.number("windows"));
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         const double shortest = run.scene.coupling.adaptive ? run.scene.coupling.adaptive->min_window : 0,
                      micro_step = run.facts.dem.micro_step.value_or(0);
         // A window has at least one micro step.
         const std::string finer =
             0.1 * shortest < micro_step
                 ? fmt::format(" and dem.micro_step = {:.2g} s (now {:.2g})", 0.1 * shortest, micro_step)
                 : "";
         return fmt::format(
             "{:.2g} of the windows have the shortest length allowed and an error above the tolerance "
             "(limit {:.2g}): use coupling.adaptive.min_window = {:.2g} s (now {:.2g}){}",
             f.value, limit, 0.1 * shortest, shortest, finer);
       }});
  table.push_back(
      {"constraints", "mbd_largest_constraint_violation", 1e-4,
       "constraint equations are satisfied to rounding at each step, redundant ones as far as data of six "
       "digits allow; relative to the length of the loop, or in rad",
       "a shorter step, or data of more digits", fixed,
       [](const RunFigures& run) { return of_run(run.facts.mbd.largest_constraint_violation); },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "the equations of closed loops are violated by {:.2g} (limit {:.0e}): {}, or give the "
             "positions and axes of the loops' joints with more digits",
             f.value, limit, finer_step(run.scene, limit / f.value));
       }});
  table.push_back(
      {"harmonic_step", "mbd_periods_per_step", 0.1,
       "a step must be a small part of the period of a harmonic force or motion; at a tenth the error is "
       "some percent of its effect",
       "a shorter step", fixed, [](const RunFigures& run) { return of_run(run.facts.mbd.periods_per_step); },
       [](const RunFigures& run, const Figure& f, double limit) {
         const double step = run.scene.mbd && run.scene.mbd->integrator.step ? *run.scene.mbd->integrator.step
                                                                             : run.scene.coupling.window;
         return fmt::format(
             "a step holds {:.2g} periods of the fastest harmonic force or motion (limit {:.2g}): use "
             "mbd.integrator.step = {:.2g} s (now {:.2g})",
             f.value, limit, 0.5 * limit / f.value * step, step);
       }});
  table.push_back(
      {"reaction", "mbd_largest_reaction_N / mbd_reaction_scale_N", 1000,
       "a joint that bears a thousand times the sum of weights, inertia forces and loads works against "
       "another joint; levers and toggles of real machines stay below",
       "data of more digits, or one joint less", fixed,
       [](const RunFigures& run) -> Figures {
         Figures figures = share(run.facts.mbd.largest_reaction, run.facts.mbd.reaction_scale);
         const auto& joint = run.facts.mbd.most_loaded_joint;
         if (figures && joint) figures->front().of = "joint '" + *joint + "'";
         return figures;
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "{} bears {:.3g} N, {:.2g} times the forces that act in the machine (limit {:.4g}): give "
             "positions and axes of the joints in its loop with more digits, or replace one that "
             "repeats another by \"spherical\" or \"cylindrical\"",
             f.of == whole_run ? "a joint" : f.of, run.facts.mbd.largest_reaction.value_or(0), f.value,
             limit);
       }});
  table.push_back(
      {"freedom", "dof - mbd_dof_lowest", 0,
       "a machine keeps its degrees of freedom; one that is lost during the run is locked by equations that "
       "only inexact data make independent",
       "data of more digits, or one joint less", fixed,
       [](const RunFigures& run) -> Figures {
         const std::optional<double> start = run.facts.mbd.dof, lowest = run.facts.mbd.lowest_dof;
         return start && lowest ? of_run(std::max(0.0, *start - *lowest)) : std::nullopt;
       },
       [](const RunFigures& run, const Figure& f, double) {
         return fmt::format(
             "{:.0f} of {} degrees of freedom vanish during the run (limit 0): give positions and "
             "axes of the joints of closed loops with more digits, or replace one that repeats another "
             "by \"spherical\" or \"cylindrical\"",
             f.value, run.facts.mbd.dof.value_or(0));
       }});
  table.push_back(
      {"branch", "mbd_sharpest_turn", 20,
       "where two motions of a loop cross, a machine keeps its direction; where it changes from one motion "
       "to the other within a twentieth of a radian, the last digits of its data decide",
       "data of more digits, or a machine that does not go through that position", fixed,
       [](const RunFigures& run) { return of_run(run.facts.mbd.sharpest_turn); },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "at t = {:.6g} s the loop that {} closes can go two ways, as a parallelogram can when it lies "
             "flat, "
             "and the machine turns from one into the other, by {:.3g} per rad (limit {:.2g}): give lengths, "
             "positions and axes of this loop with more digits, or keep the machine away from that "
             "position by `limits`, a third crank or a gear",
             run.facts.mbd.sharpest_turn_at.value_or(0), run.facts.mbd.sharpest_turn_loop.value_or("a joint"),
             f.value, limit);
       }});
  table.push_back(
      {"locked", "mbd_locked", 0,
       "a machine without prescribed motion that cannot move is a frame: mostly it has a joint too many, or "
       "lengths and axes that do not fit",
       "one joint less, or lengths and axes that fit", fixed,
       [](const RunFigures& run) { return of_run(run.facts.mbd.locked); },
       [](const RunFigures&, const Figure&, double) {
         return std::string(
             "the loops leave the machine no degree of freedom, so that nothing moves (limit 0): check "
             "lengths and axes of its loops and leave out a joint that it does not need; data of "
             "fewer than six digits need a larger mbd.integrator.assembly_tolerance");
       }});
  table.push_back(
      {"cavitation", "mbd_cavitated_s", 0,
       "below the cavitation pressure oil is vapour, and the equations of the chambers of a cylinder are not "
       "valid: they go on to pressures that no liquid has",
       "a larger valve, pump or tank pressure, or a smaller load", fixed,
       [](const RunFigures& run) { return of_run(run.facts.mbd.cavitated); },
       [](const RunFigures&, const Figure& f, double) {
         return fmt::format(
             "the oil of a hydraulic cylinder cavitated for {:.3g} s (limit 0): give that cylinder, which a "
             "warning names, a larger valve_flow, pump_flow or tank_pressure, or a smaller load",
             f.value);
       }});
  table.push_back(
      {"contact_depth", "mbd_contact_depth_share", 0.25,
       "points and normals of a contact are those of shapes that hardly overlap; loads at rest press by much "
       "less, and at the middle of the thinner shape the run ends",
       "more stiffness of the materials in `mbd.contact`", fixed,
       [](const RunFigures& run) { return of_run(run.facts.mbd.contact_depth); },
       [](const RunFigures& run, const Figure& f, double limit) {
         // Depth grows with force / stiffness, and that of an impact with 1 / sqrt(stiffness).
         const double ratio = f.value / limit;
         return fmt::format(
             "{} pressed into each other by {:.2g} of the thinner one at t = {:.6g} s (limit {:.2g}): give "
             "their "
             "materials {:.2g} times the stiffness where a load presses them, {:.2g} times where they hit "
             "each "
             "other",
             run.facts.mbd.contact_depth_of.value_or("two shapes"), f.value,
             run.facts.mbd.contact_depth_at.value_or(0), limit, ratio, ratio * ratio);
       }});
  table.push_back(
      {"shortened_steps", "mbd_shortened_steps / mbd_steps", 0.01,
       "an impact sometimes needs a step in parts, which is as accurate as others; at one step "
       "in a hundred the step is too long for the machine",
       "a shorter step or a smaller error tolerance", fixed,
       [](const RunFigures& run) { return share(run.facts.mbd.shortened_steps, run.facts.mbd.steps); },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "{:.2g} of the steps of the multibody part were taken in parts (limit {:.2g}): {}", f.value,
             limit, finer_step(run.scene, 0.25));
       }});
  table.push_back(
      {"doubtful_steps", "mbd_doubtful_steps", 0,
       "a step for which Newton's method did not contract may have ended at another root of its equations",
       "a shorter step or a smaller error tolerance", fixed,
       [](const RunFigures& run) { return of_run(run.facts.mbd.doubtful_steps); },
       [](const RunFigures& run, const Figure& f, double) {
         return fmt::format("{:.0f} steps of the multibody part may have ended at a wrong root (limit 0): {}",
                            f.value, finer_step(run.scene, 0.01));
       }});
  table.push_back({"position_error", "mbd_position_error_estimate", 0.01,
                   "estimated error of positions due to the step, relative to the size of the machine: 1 % "
                   "shows in a plot",
                   "a shorter step or a smaller error tolerance", fixed,
                   [](const RunFigures& run) { return of_run(value_of(run.facts.mbd.position_error)); },
                   [](const RunFigures& run, const Figure& f, double limit) {
                     return fmt::format(
                         "positions are off by some {:.2g} of the machine's size at the end (estimate, limit "
                         "{:.2g}): {}",
                         f.value, limit, finer_step(run.scene, limit / f.value));
                   }});
  table.push_back(
      {"local_errors", "mbd_local_error_sum", 0.01,
       "applies where `mbd_position_error_estimate` is not a number: sum of the magnitudes of the position "
       "errors of all steps; the true error is up to six times as large, in a chaotic motion more, and often "
       "smaller",
       "a shorter step, a smaller error tolerance, or `--estimate richardson`", fixed,
       [](const RunFigures& run) -> Figures {
         if (value_of(run.facts.mbd.position_error)) return std::nullopt;
         return of_run(run.facts.mbd.local_error_sum);
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         std::string why =
             run.facts.mbd.position_error ? run.facts.mbd.position_error->reason : "not estimated";
         why = why.substr(0, why.find(';'));
         return fmt::format(
             "the error of positions is {}; what the steps leave out adds up to {:.2g} of the machine's "
             "size (limit {:.2g}): {}, or measure the error with tandem run --estimate richardson",
             why, f.value, limit, finer_step(run.scene, limit / f.value));
       }});
  table.push_back(
      {"energy_error", "mbd_energy_error_estimate_J / mbd_energy_scale_J", 0.01,
       "estimated error of the energy due to the step, relative to the energy that moves",
       "a shorter step or a smaller error tolerance", fixed,
       [](const RunFigures& run) {
         return share(value_of(run.facts.mbd.energy_error), run.facts.mbd.energy_scale);
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "the energy of the multibody part is off by some {:.2g} of what moves in it (estimate, "
             "limit {:.2g}): {}",
             f.value, limit, finer_step(run.scene, limit / f.value));
       }});
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
       "a larger domain, an outlet, or the scale of a mesh", fixed,
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
       "precision `double`, or a participant that records all forces", fixed,
       [](const RunFigures& run) { return of_run(run.number("momentum_balance")); },
       [](const RunFigures&, const Figure& f, double limit) {
         return fmt::format(
             "the momentum of the particles is off by {:.2g} of what acts on them (limit {:.0e}): use "
             "\"precision\": \"double\", or a particle participant that records all forces of walls "
             "(docs/protocol.md)",
             f.value, limit);
       }});
  table.push_back(
      {"momentum_windows", "momentum_balance_windows", 1e-3,
       "the same momentum balance, window by window: a load that comes a window late, or a mean that is the "
       "value at an end, cancels over the run",
       "a participant that gives each window its own mean load", fixed,
       [](const RunFigures& run) { return of_run(run.number("momentum_balance_windows")); },
       [](const RunFigures&, const Figure& f, double limit) {
         return fmt::format(
             "in single windows the momentum of the particles changes by {:.2g} of what acts on them more "
             "than "
             "the loads explain (limit {:.0e}): use a particle participant whose load is the mean over the "
             "same window; tandem conform --role dem names the fault (docs/conform.md)",
             f.value, limit);
       }});
  table.push_back(
      {"body_momentum", "border.BODY.momentum_residual", 1e-3,
       "momentum that a body gets, against the impulses of load and gravity, where nothing else acts in its "
       "free direction: no joint and no force, or a slide of the ground; contacts with other bodies count by "
       "the "
       "impulses that the participant tells; a method that is exact for constant forces, as most are, leaves "
       "rounding, and mbd_server 2e-14",
       "a participant that applies all of the load and gravity to the mass of the scene", fixed,
       [](const RunFigures& run) { return residuals_of_bodies(run, "momentum_residual"); },
       [](const RunFigures&, const Figure& f, double limit) {
         return fmt::format(
             "{} gets a momentum that is off by {:.2g} of the impulses of load and gravity, of which it "
             "should be "
             "the sum (limit {:.0e}): use a multibody participant that applies all of the load and gravity "
             "to the "
             "mass of the scene (tandem conform --role mbd --check force_impulse --check free_fall)",
             f.of, f.value, limit);
       }});
  table.push_back(
      {"body_angular_momentum", "border.BODY.angular_momentum_residual", 0.01,
       "the same for angular momentum, of bodies without joints and on a hinge of the ground; the error of a "
       "spinning free body is that of the step, 1e-4 with mbd_server, and `tandem conform` allows 1e-2",
       "a participant that applies all torques, or a shorter step", fixed,
       [](const RunFigures& run) { return residuals_of_bodies(run, "angular_momentum_residual"); },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "{} gets an angular momentum that is off by {:.2g} of the impulses of the torques, of which it "
             "should "
             "be the sum (limit {:.2g}): use a multibody participant that applies torques about the centre "
             "of mass "
             "and in world axes (tandem conform --role mbd --check torque_impulse); with mbd_server {}",
             f.of, f.value, limit, finer_step(run.scene, limit / f.value));
       }});
  table.push_back(
      {"motion_chain", "motion_jumps[].share", 1e-6,
       "each window begins in the state in which the last one ended, also after a restart: what a body "
       "jumps, "
       "relative to its size and added up over the windows, is rounding",
       "a participant whose windows follow each other", fixed,
       [](const RunFigures& run) { return shares_of_bodies(run, "motion_jumps"); },
       [](const RunFigures& run, const Figure& f, double limit) {
         const auto [jump, time] = difference_of(run, "motion_jumps", f.of);
         return fmt::format(
             "{} jumps between windows: at t = {:.6g} s it begins {} from where it ended before; all jumps "
             "are "
             "{:.2g} of its size (limit {:.0e}): use a multibody participant whose windows begin in the "
             "state in "
             "which the last one ended, also after resume (tandem conform --role mbd --check motion_chain "
             "--check motion_checkpoint)",
             f.of, time, jump, f.value, limit);
       }});
  table.push_back({"body_frames", "frame_differences[].share", 1e-6,
                   "the results have a body where its motion ended, and with that velocity; the difference, "
                   "relative to its "
                   "size, is rounding",
                   "a participant whose frames show the bodies as it moves them", fixed,
                   [](const RunFigures& run) { return shares_of_bodies(run, "frame_differences"); },
                   [](const RunFigures& run, const Figure& f, double limit) {
                     const auto [wrong, time] = difference_of(run, "frame_differences", f.of);
                     return fmt::format(
                         "{} is elsewhere in the results than in the motion that loads the particles: at t = "
                         "{:.6g} s by {}, "
                         "{:.2g} of its size (limit {:.0e}): use a multibody participant whose frames have "
                         "the state at the "
                         "end of the window (tandem conform --role mbd --check observe_bodies)",
                         f.of, time, wrong, f.value, limit);
                   }});
  table.push_back(
      {"joints", "joint_violations[].share", 1e-3,
       "the bodies of the results are where the joints let them be, prescribed coordinates follow their "
       "motions, and the joint coordinates of the results are those of the bodies; relative to the size of "
       "the machine, or in rad; ten times `mbd.integrator.assembly_tolerance`, beyond which mbd_server ends "
       "the run",
       "a participant that satisfies the joints", limit_of_joints,
       [](const RunFigures& run) { return shares_of(run, "joint_violations"); },
       [](const RunFigures& run, const Figure& f, double limit) {
         const Json& joint = entry_of(run, "joint_violations", f.of);
         return fmt::format(
             "{} is violated: in the results at t = {:.6g} s {}, {:.2g} of the machine's size or in rad "
             "(limit "
             "{:.2g}): use a multibody participant that satisfies each joint which it takes (tandem conform "
             "--role mbd --check joint_reaction --check joint_motion)",
             f.of, figure_of(joint, "time_s"), joint.value("what", ""), f.value, limit);
       }});
  table.push_back(
      {"body_path", "path_differences[].share", 0.01,
       "a body moves and rotates by the integral of its velocities; what is open beyond one window times the "
       "changes of the velocity, which bounds methods of first order and impacts, relative to the way",
       "a participant whose poses follow from its velocities, or a shorter window", fixed,
       [](const RunFigures& run) { return shares_of(run, "path_differences"); },
       [](const RunFigures& run, const Figure& f, double limit) {
         const Json& path = entry_of(run, "path_differences", f.of);
         const bool is_angle = path.contains("open_rad");
         return fmt::format(
             "the {} does not follow from its velocity: by t = {:.6g} s it is off by {:.3g} {}, {:.2g} of "
             "the way (limit {:.2g}): use a multibody participant whose poses are the integral of its "
             "velocities (tandem conform --role mbd --check {}), or a shorter coupling.window where the body "
             "vibrates within one",
             f.of, figure_of(path, "time_s"), figure_of(path, is_angle ? "open_rad" : "open_m"),
             is_angle ? "rad" : "m", f.value, limit, is_angle ? "rotation" : "free_fall");
       }});
  table.push_back(
      {"body_energy", "body_energy_differences[].share", 1e-3,
       "the energy of the bodies in the results changes as their poses and velocities say, by the masses, "
       "inertias, gravity and linear springs of the scene, relative to the energy that moves: rounding, 1e-7 "
       "in single precision; applies where nothing else stores energy",
       "a participant that gives the energy of all bodies and springs", fixed,
       [](const RunFigures& run) { return shares_of(run, "body_energy_differences"); },
       [](const RunFigures& run, const Figure& f, double limit) {
         const Json& energy = entry_of(run, "body_energy_differences", f.of);
         return fmt::format(
             "the energy of the bodies in the results has changed by {:.4g} J at t = {:.6g} s, and by {:.4g} "
             "J by their poses and velocities, a difference of {:.2g} of the energy that moves (limit "
             "{:.0e}): use a multibody participant that gives kinetic and potential energy of all bodies "
             "and springs (tandem conform --role mbd --check energy)",
             figure_of(energy, "reported_J"), figure_of(energy, "time_s"), figure_of(energy, "computed_J"),
             f.value, limit);
       }});
  table.push_back(
      {"contact_load", "unloaded_walls[].spheres", 0,
       "where a sphere overlaps a plane or a face of a box by more than 0.1 % of its radius and approaches "
       "it, "
       "every contact law has a force; where the load of that body is zero in a frame, it is recorded "
       "elsewhere",
       "a participant that records the load of each wall on its body", fixed,
       [](const RunFigures& run) -> Figures {
         const auto found = run.summary.find("unloaded_walls");
         if (found == run.summary.end()) return std::nullopt;
         std::vector<Figure> figures;
         for (const Json& body : *found)
           figures.push_back({body.value("of", ""), figure_of(body, "spheres")});
         return figures;
       },
       [](const RunFigures& run, const Figure& f, double) {
         const Json& body = entry_of(run, "unloaded_walls", f.of);
         return fmt::format(
             "{} has no load in the frame of t = {:.6g} s, in which spheres press on its walls: {} (limit "
             "0): "
             "use a particle participant that records the load of each wall on the body of the wall (tandem "
             "conform --role dem --check weight_on_body --check load_on_ground)",
             f.of, figure_of(body, "time_s"), body.value("example", ""));
       }});
  table.push_back(
      {"ending", "bad_endings[]", 0,
       "a program that ends with another status than 0 or by a signal says that it failed: its last figures "
       "may be wrong",
       "a participant that ends with status 0 after its report", fixed,
       [](const RunFigures& run) -> Figures {
         const auto found = run.summary.find("bad_endings");
         if (found == run.summary.end()) return std::nullopt;
         std::vector<Figure> figures;
         for (const Json& program : *found) figures.push_back({program.value("of", ""), 1});
         return figures;
       },
       [](const RunFigures& run, const Figure& f, double) {
         return fmt::format(
             "{} {} after the run (limit: status 0): use a participant that ends with status 0 after its "
             "report (tandem conform --check finish), and look for its last words in run.log",
             f.of, entry_of(run, "bad_endings", f.of).value("what", ""));
       }});
  table.push_back(
      {"particle_frames", "false_spheres[].spheres", 0,
       "a frame has the spheres of the scene that are not lost, with their radii, inside the domain; they "
       "come "
       "in and leave as the scene says, and go no deeper into each other and no farther than the account "
       "says",
       "a participant whose frames show its spheres", fixed,
       [](const RunFigures& run) -> Figures {
         const auto found = run.summary.find("false_spheres");
         if (found == run.summary.end()) return std::nullopt;
         std::vector<Figure> figures;
         for (const Json& kind : *found)
           figures.push_back({kind.value("of", ""), figure_of(kind, "spheres")});
         return figures;
       },
       [](const RunFigures& run, const Figure& f, double) {
         const Json& kind = entry_of(run, "false_spheres", f.of);
         return fmt::format(
             "in the frame of t = {:.6g} s {:.0f} spheres are wrong (limit 0): {}; use a particle "
             "participant "
             "whose frames have the spheres of the scene (tandem conform --role dem --check {})",
             figure_of(kind, "time_s"), f.value, kind.value("example", ""),
             kind.value("check", "observe_particles"));
       }});
  table.push_back({"particle_account", "particle_frame_differences[].share", 1e-3,
                   "momentum and energy of the spheres in a frame are those of the account, to the single "
                   "precision of the "
                   "frame (2e-7), gravity acts on their mass, and their centre of mass moves by the momentum",
                   "a participant whose account and frames are of the same spheres", fixed,
                   [](const RunFigures& run) -> Figures {
                     const auto found = run.summary.find("particle_frame_differences");
                     if (found == run.summary.end()) return std::nullopt;
                     std::vector<Figure> figures;
                     for (const Json& of : *found)
                       figures.push_back({of.value("of", ""), figure_of(of, "share")});
                     return figures;
                   },
                   [](const RunFigures& run, const Figure& f, double limit) {
                     const Json& of = entry_of(run, "particle_frame_differences", f.of);
                     return fmt::format(
                         "the {} of the frame of t = {:.6g} s {}: the difference is {:.2g} (limit {:.0e}); "
                         "use a particle "
                         "participant whose account and frames are of the same spheres and time (tandem "
                         "conform --role dem "
                         "--check observe_particles --check kinetic_energy)",
                         f.of, figure_of(of, "time_s"), of.value("values", ""), f.value, limit);
                   }});
  table.push_back(
      {"angular_momentum", "angular_momentum_balance", 0.01,
       "the angular momentum of the spheres changes from frame to frame by the torques of walls and gravity; "
       "the windows' means and the frames' single precision leave 4e-5 of the torques, 4e-4 where the window "
       "is "
       "too large",
       "a participant that records all torques, about the right point", fixed,
       [](const RunFigures& run) { return of_run(run.number("angular_momentum_balance")); },
       [](const RunFigures&, const Figure& f, double limit) {
         return fmt::format(
             "the angular momentum of the particles is off by {:.2g} of the torques that their loads have "
             "(limit "
             "{:.2g}): use a particle participant that records all torques, about the centre of mass of the "
             "body "
             "and for the ground about the world's origin (tandem conform --role dem --check torque_on_body "
             "--check load_on_ground)",
             f.value, limit);
       }});
  table.push_back(
      {"collision_steps", "windows_of_too_long_steps / windows", 0.01,
       "share of the windows in which a collision of the fastest spheres would take fewer than six micro "
       "steps, which loses 1 % of its speed, or in which spheres could pass through each other undetected",
       "the micro step that the fastest collision requires", fixed,
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
       "a fifth of the critical time", fixed,
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
       fixed,
       [](const RunFigures& run) -> Figures {
         const auto crossings = run.summary.find("wall_crossings");
         if (crossings == run.summary.end()) return std::nullopt;
         std::vector<Figure> figures;
         for (const Json& c : *crossings)
           figures.push_back(
               {fmt::format("wall '{}' of '{}' and wall '{}' of '{}'", c.value("wall_a", ""),
                            c.value("body_a", ""), c.value("wall_b", ""), c.value("body_b", "")),
                c.value("share", 0.0)});
         return figures;
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         double depth = 0, time = 0;
         for (const Json& c : run.summary["wall_crossings"])
           if (f.of == fmt::format("wall '{}' of '{}' and wall '{}' of '{}'", c.value("wall_a", ""),
                                   c.value("body_a", ""), c.value("wall_b", ""), c.value("body_b", "")))
             depth = c.value("depth_m", 0.0), time = c.value("time_s", 0.0);
         return fmt::format(
             "{} pass through each other from t = {:.4g} s on, by up to {:.2g} m, {:.2g} of the thinner "
             "one (limit {:.2g}); walls act on spheres only: give the bodies shapes with \"use\": "
             "\"contact\", or "
             "put a joint with limits (stiffness and where it stops), a bushing or a spring_damper between "
             "them",
             f.of, time, depth, f.value, limit);
       }});
  add_liquid_rules(table);
  return table;
}

}  // namespace

std::optional<double> RunFigures::number(const char* key) const {
  const auto found = summary.find(key);
  if (found == summary.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

const std::vector<Rule>& rules() {
  static const std::vector<Rule> table = make_rules();
  return table;
}

Verdict judge(const RunFigures& run) {
  Verdict verdict;
  for (const Rule& rule : rules()) {
    const auto figures = rule.measure(run);
    if (!figures) continue;
    verdict.judged.emplace_back(rule.name);
    const double limit = rule.limit_of ? rule.limit_of(run.scene) : rule.limit;
    for (const Figure& figure : *figures)
      if (!(figure.value <= limit))
        verdict.lines.push_back(
            {rule.name, figure.of, figure.value, limit, rule.sentence(run, figure, limit)});
  }
  return verdict;
}

Json to_json(const Verdict& verdict) {
  Json lines = Json::array();
  for (const VerdictLine& line : verdict.lines)
    lines.push_back({{"rule", line.rule},
                     {"of", line.of},
                     {"value", line.value},
                     {"limit", line.limit},
                     {"sentence", line.sentence}});
  return {{"status", verdict.suspect() ? "suspect" : "ok"},
          {"judged", verdict.judged},
          {"lines", lines},
          {"not_judged", verdict.not_judged}};
}

std::string rules_as_markdown() {
  std::string text =
      "| rule | figure of `summary.json` | limit | why this limit | what a line says to use "
      "|\n|---|---|---|---|---|\n";
  for (const Rule& rule : rules())
    text +=
        fmt::format("| {} | `{}` | {} | {} | {} |\n", rule.name, rule.figure,
                    std::isfinite(rule.limit) ? limit_text(rule.limit) : "none", rule.reason, rule.instead);
  return text;
}

}  // namespace tandem::launch
