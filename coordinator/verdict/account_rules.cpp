#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/verdict/figures.hpp"
#include "coordinator/verdict/rules.hpp"

namespace tandem::launch {
namespace {

// A residual of all bodies of `border` that have it.
Figures residuals_of_bodies(const RunFigures& run, const char* key) {
  const auto bodies = run.summary.find("border");
  if (bodies == run.summary.end()) return std::nullopt;
  std::vector<Figure> figures;
  for (const auto& [name, body] : bodies->items())
    if (body.contains(key)) figures.push_back({fmt::format("body '{}'", name), figure_of(body, key)});
  return figures.empty() ? Figures() : figures;
}

// Of an entry of `motion_jumps` or `frame_differences`.
std::string of_body(const Json& entry) {
  return fmt::format("body '{}'", entry.value("body", ""));
}

// "0.05 m, 0 rad, 0 m/s and 0 rad/s", the difference of such an entry.
std::string difference(const Json& body) {
  return fmt::format("{:.3g} m, {:.3g} rad, {:.3g} m/s and {:.3g} rad/s", figure_of(body, "position_m"),
                     figure_of(body, "rotation_rad"), figure_of(body, "velocity_m_per_s"),
                     figure_of(body, "angular_velocity_rad_per_s"));
}

// Ten times the accuracy of the scene's data: mbd_server ends the run there.
double limit_of_joints(const scene::Scene& scene) {
  return scene.mbd ? std::max(1e-3, 10 * scene.mbd->integrator.assembly_tolerance) : 1e-3;
}

}  // namespace

void add_account_rules(std::vector<Rule>& table) {
  table.push_back(
      {"momentum_windows", "momentum_balance_windows", 1e-3,
       "the same momentum balance, window by window: a load that comes a window late, or a mean that is the "
       "value at an end, cancels over the run",
       "a participant that gives each window its own mean load", nullptr,
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
       "a participant that applies all of the load and gravity to the mass of the scene", nullptr,
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
       "a participant that applies all torques, or a shorter step", nullptr,
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
       "a participant whose windows follow each other", nullptr,
       [](const RunFigures& run) { return figures_of(run, "motion_jumps", "share", of_body); },
       [](const RunFigures& run, const Figure& f, double limit) {
         const Json& jump = entry_of(run, "motion_jumps", f.of, of_body);
         return fmt::format(
             "{} jumps between windows: at t = {:.6g} s it begins {} from where it ended before; all jumps "
             "are "
             "{:.2g} of its size (limit {:.0e}): use a multibody participant whose windows begin in the "
             "state in "
             "which the last one ended, also after resume (tandem conform --role mbd --check motion_chain "
             "--check motion_checkpoint)",
             f.of, figure_of(jump, "time_s"), difference(jump), f.value, limit);
       }});
  table.push_back(
      {"body_frames", "frame_differences[].share", 1e-6,
       "the results have a body where its motion ended, and with that velocity; the difference, "
       "relative to its "
       "size, is rounding",
       "a participant whose frames show the bodies as it moves them", nullptr,
       [](const RunFigures& run) { return figures_of(run, "frame_differences", "share", of_body); },
       [](const RunFigures& run, const Figure& f, double limit) {
         const Json& wrong = entry_of(run, "frame_differences", f.of, of_body);
         return fmt::format(
             "{} is elsewhere in the results than in the motion that loads the particles: at t = "
             "{:.6g} s by {}, "
             "{:.2g} of its size (limit {:.0e}): use a multibody participant whose frames have "
             "the state at the "
             "end of the window (tandem conform --role mbd --check observe_bodies)",
             f.of, figure_of(wrong, "time_s"), difference(wrong), f.value, limit);
       }});
  table.push_back(
      {"joints", "joint_violations[].share", 1e-3,
       "the bodies of the results are where the joints let them be, prescribed coordinates follow their "
       "motions, and the joint coordinates of the results are those of the bodies; relative to the size of "
       "the machine, or in rad; ten times `mbd.integrator.assembly_tolerance`, beyond which mbd_server ends "
       "the run",
       "a participant that satisfies the joints", limit_of_joints,
       [](const RunFigures& run) { return figures_of(run, "joint_violations"); },
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
       "a participant whose poses follow from its velocities, or a shorter window", nullptr,
       [](const RunFigures& run) { return figures_of(run, "path_differences"); },
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
       "a participant that gives the energy of all bodies and springs", nullptr,
       [](const RunFigures& run) { return figures_of(run, "body_energy_differences"); },
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
       "it, and did so two micro steps before, every contact law has a force; where the load of that body is "
       "zero in a frame, it is recorded "
       "elsewhere",
       "a participant that records the load of each wall on its body", nullptr,
       [](const RunFigures& run) { return figures_of(run, "unloaded_walls", "spheres"); },
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
       "a participant that ends with status 0 after its report", nullptr,
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
       "a participant whose frames show its spheres", nullptr,
       [](const RunFigures& run) { return figures_of(run, "false_spheres", "spheres"); },
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
                   "a participant whose account and frames are of the same spheres", nullptr,
                   [](const RunFigures& run) { return figures_of(run, "particle_frame_differences"); },
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
       "a participant that records all torques, about the right point", nullptr,
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
}

}  // namespace tandem::launch
