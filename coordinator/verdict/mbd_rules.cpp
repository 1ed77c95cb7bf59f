#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/verdict/figures.hpp"
#include "coordinator/verdict/rules.hpp"

namespace tandem::launch {
namespace {

std::optional<double> value_of(const std::optional<protocol::fact::Estimate>& estimate) {
  return estimate ? estimate->value : std::nullopt;
}

// Whether a run could not be compared even with one whose steps are twice as long.
bool is_unresolved(const std::optional<protocol::fact::Estimate>& estimate) {
  return estimate && !estimate->value &&
         estimate->reason.find("do not resolve the motion") != std::string::npos;
}

}  // namespace

void add_mbd_rules(std::vector<Rule>& table) {
  table.push_back(
      {"energy_mbd", "abs(mbd_largest_energy_balance_J) / mbd_energy_scale_J", 0.01,
       "a change of the energy of the multibody part without work of forces, motions or particles is an "
       "error of its integration; 1 % of the energy that moves shows in a plot",
       "a shorter step or a smaller error tolerance", nullptr,
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
      {"constraints", "mbd_largest_constraint_violation", 1e-4,
       "constraint equations are satisfied to rounding at each step, redundant ones as far as data of six "
       "digits allow; relative to the length of the loop, or in rad",
       "a shorter step, or data of more digits", nullptr,
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
       "a shorter step", nullptr,
       [](const RunFigures& run) { return of_run(run.facts.mbd.periods_per_step); },
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
       "data of more digits, or one joint less", nullptr,
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
       "data of more digits, or one joint less", nullptr,
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
       "data of more digits, or a machine that does not go through that position", nullptr,
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
       "one joint less, or lengths and axes that fit", nullptr,
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
       "a larger valve, pump or tank pressure, or a smaller load", nullptr,
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
       "more stiffness of the materials in `mbd.contact`", nullptr,
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
      {"tyre_bottoming", "mbd_tyre_bottoming_share", 0.01,
       "a rim that stands on the road beside its tyre takes load and friction that the tyre does not know "
       "of; "
       "an impact through the tyre onto the rim passes in less than a hundredth of its time on the road",
       "a smaller shape, a stiffer tyre, or `ignore` of wheel and ground", nullptr,
       [](const RunFigures& run) { return of_run(run.facts.mbd.tyre_bottoming); },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "{} bear load on the same ground, from t = {:.6g} s on, for {:.2g} of the time that the tyre is "
             "on "
             "it (limit {:.2g}): make the shape smaller than the loaded radius of the tyre, give the tyre "
             "more "
             "stiffness, or add the wheel and \"ground\" to mbd.contact.ignore",
             run.facts.mbd.tyre_bottoming_of.value_or("a tyre and a shape of its wheel"),
             run.facts.mbd.tyre_bottoming_at.value_or(0), f.value, limit);
       }});
  table.push_back(
      {"shortened_steps", "mbd_shortened_steps / mbd_steps", 0.01,
       "an impact sometimes needs a step in parts, which is as accurate as others; at one step "
       "in a hundred the step is too long for the machine",
       "a shorter step or a smaller error tolerance", nullptr,
       [](const RunFigures& run) { return share(run.facts.mbd.shortened_steps, run.facts.mbd.steps); },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "{:.2g} of the steps of the multibody part were taken in parts (limit {:.2g}): {}", f.value,
             limit, finer_step(run.scene, 0.25));
       }});
  table.push_back(
      {"doubtful_steps", "mbd_doubtful_steps", 0,
       "a step for which Newton's method did not contract may have ended at another root of its equations",
       "a shorter step or a smaller error tolerance", nullptr,
       [](const RunFigures& run) { return of_run(run.facts.mbd.doubtful_steps); },
       [](const RunFigures& run, const Figure& f, double) {
         return fmt::format("{:.0f} steps of the multibody part may have ended at a wrong root (limit 0): {}",
                            f.value, finer_step(run.scene, 0.01));
       }});
  table.push_back(
      {"position_error", "mbd_position_error_estimate", 0.01,
       "estimated error of positions due to the step, relative to the size of the machine, and of "
       "joint coordinates, relative to how far they move: 1 % shows in a plot; an error that not even steps "
       "twice as long can measure is beyond the limit",
       "a shorter step or a smaller error tolerance", nullptr,
       [](const RunFigures& run) {
         if (is_unresolved(run.facts.mbd.position_error))
           return of_run(std::numeric_limits<double>::quiet_NaN());
         return of_run(value_of(run.facts.mbd.position_error));
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         constexpr double grown = 100;
         if (!std::isfinite(f.value))
           return fmt::format(
               "the error of positions is unknown, since steps twice as long do not resolve the "
               "motion (limit {:.2g}): {}",
               limit, finer_step(run.scene, 0.25));
         const double local = run.facts.mbd.local_error_sum.value_or(f.value);
         return fmt::format(
             "positions are off by some {:.2g} of the machine's size, or of how far a joint moves, at "
             "the end (estimate, limit {:.2g}{}): {}",
             f.value, limit,
             f.value > grown * local
                 ? fmt::format("; the steps leave out {:.2g}, and small errors grow, as in a "
                               "chaotic motion, whose positions have no meaning after a time",
                               local)
                 : std::string(),
             finer_step(run.scene, limit / f.value));
       }});
  table.push_back(
      {"local_errors", "mbd_local_error_sum", 0.01,
       "applies where `mbd_position_error_estimate` is not a number: largest sum of the magnitudes of the "
       "errors of a joint coordinate in all steps, relative to how far it moves; the true error is this "
       "times "
       "the growth of small errors, in a chaotic motion much more, and often smaller",
       "a shorter step, a smaller error tolerance, or `--estimate richardson`", nullptr,
       [](const RunFigures& run) -> Figures {
         if (value_of(run.facts.mbd.position_error) || is_unresolved(run.facts.mbd.position_error))
           return std::nullopt;
         return of_run(run.facts.mbd.local_error_sum);
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         std::string why =
             run.facts.mbd.position_error ? run.facts.mbd.position_error->reason : "not estimated";
         why = why.substr(0, why.find(';'));
         return fmt::format(
             "the error of positions is {}; what the steps leave out adds up to {:.2g} of how far a "
             "joint moves (limit {:.2g}): {}, or measure the error with tandem run --estimate richardson",
             why, f.value, limit, finer_step(run.scene, limit / f.value));
       }});
  table.push_back(
      {"energy_error", "mbd_energy_error_estimate_J / mbd_energy_scale_J", 0.01,
       "estimated error of the energy due to the step, relative to the energy that moves",
       "a shorter step or a smaller error tolerance", nullptr,
       [](const RunFigures& run) {
         return share(value_of(run.facts.mbd.energy_error), run.facts.mbd.energy_scale);
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "the energy of the multibody part is off by some {:.2g} of what moves in it (estimate, "
             "limit {:.2g}): {}",
             f.value, limit, finer_step(run.scene, limit / f.value));
       }});
}

}  // namespace tandem::launch
