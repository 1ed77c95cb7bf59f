#include "mbd_server/coupling/facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "mbd_server/forces/spring_damper.hpp"
#include "protocol/facts.hpp"

namespace tandem::mbd {
namespace {

using Json = nlohmann::ordered_json;

// Terms that this scene does not need and that are therefore not computed.
std::vector<std::string> left_out(const Model& model) {
  std::vector<std::string> list;
  if (model.closures.empty()) list.push_back("no closed loops: no multipliers");
  std::size_t idle = 0;
  for (const Closure& closure : model.closures) idle += closure.idle.size();
  if (idle > 0) list.push_back(fmt::format("{} equations across the plane of planar loops", idle));
  if (!model.gyroscopic)
    list.push_back("no gyroscopic or centrifugal forces on the joints: their derivatives left out");
  if (!model.damped) list.push_back("no dampers: no damping terms");
  if (!model.driven) list.push_back("no prescribed motion");
  if (forces_of<Spring>(model).empty()) list.push_back("no springs between points");
  if (model.contact.impacts_within_steps) list.push_back("no steps that end where contacts begin and end");
  if (model.contact.time_stepping)
    list.push_back("no impacts of bodies: time stepping, one convex minimum for each step of fixed length");
  if (model.welded > 0)
    list.push_back(fmt::format("{} bodies welded to another or to the ground: merged", model.welded));
  return list;
}

}  // namespace

std::string configured_facts(const Model& model, const scene::Scene& scene, const AssemblyReport& assembly,
                             const std::vector<Components>& undetermined) {
  Json boundary = Json::array();
  for (const int body : model.boundary) boundary.push_back(scene.mbd->bodies[body].name);
  Json closures = Json::array(), moved;
  for (const Closure& closure : model.closures) closures.push_back(closure.name);
  if (assembly.moved_body != none)
    moved = {{"body", scene.mbd->bodies[assembly.moved_body].name}, {"distance_m", assembly.distance}};
  Json reactions = Json::array();
  for (std::size_t j = 0; j < undetermined.size(); ++j)
    if (undetermined[j] != 0)
      reactions.push_back(
          {{"joint", scene.mbd->joints[j].name}, {"components", component_names(undetermined[j])}});
  Json misfit;
  if (assembly.misfit > 1e-12) misfit = {{"equation", assembly.misfit_of}, {"share", assembly.misfit}};
  // Nothing moves, and no load or motion is there that could move the machine.
  const bool locked = model.freedoms > 0 && !model.driven &&
                      std::min(assembly.degrees_of_freedom, assembly.lasting_degrees_of_freedom) <= 0;
  protocol::MbdFacts facts;
  facts.dof = assembly.degrees_of_freedom;
  facts.redundant_equations = assembly.redundant;
  facts.locked = locked ? 1 : 0;
  facts.left_out = left_out(model);
  const Json others{{"bodies", model.bodies.size()}, {"boundary_bodies", boundary},
                    {"mbd_closures", closures},      {"mbd_assembly", moved},
                    {"mbd_misfit", misfit},          {"mbd_undetermined_reactions", reactions}};
  return protocol::encode_facts(facts, others);
}

namespace {

std::vector<std::string> run_warnings(const RunFigures& f) {
  std::vector<std::string> list;
  if (!f.unstable_start.empty()) list.push_back(f.unstable_start);
  const ShortenedSteps& s = f.shortened;
  if (s.count > 0)
    list.push_back(
        fmt::format("{} steps of the multibody part were taken in parts, because Newton's method found no "
                    "root that can be trusted, or a force over a coordinate changed within them: "
                    "first at t = {:.6g} s, at {}; the shortest part took {:.3g} s; give mbd.integrator.step "
                    "= {:.2g}, or "
                    "mbd.integrator.error_tolerance",
                    s.count, s.first_time, s.worst, s.shortest, s.shortest));
  if (s.doubtful > 0)
    list.push_back(fmt::format(
        "{} of these parts, of the shortest length, came out at a root to which Newton's method did not "
        "contract: the motion may be wrong from t = {:.6g} s on",
        s.doubtful, s.first_time));
  if (f.counters.unresolved > 0)
    list.push_back(fmt::format(
        "{} steps have an error of the velocity above mbd.integrator.error_tolerance that does not fall with "
        "the step: "
        "the machine passes a singular position, where round-off counts, or a velocity jumps; see by "
        "another tolerance, or with more digits in the positions of its loops, whether the motion depends on "
        "it",
        f.counters.unresolved));
  // Short runs, and the first steps of a run, may have a few such steps without being stiff.
  if (f.counters.stiff > 100 && f.counters.stiff > f.counters.steps / 2)
    list.push_back(fmt::format(
        "stability and not accuracy limited {} of {} steps of the explicit method: a part of the "
        "machine is stiff, and generalized_alpha in mbd.integrator.method would take longer steps",
        f.counters.stiff, f.counters.steps));
  if (!f.cavitated.empty())
    list.push_back(fmt::format(
        "the oil of {} cavitated: its pressure is below the cavitation_pressure from t = {:.6g} s on, for "
        "{:.3g} s in all cylinders together, and as low as {:.3g} Pa, where the law of the chambers is not "
        "valid: give the cylinder a larger valve_flow, pump_flow or tank_pressure, or a smaller load",
        f.cavitated, f.totals.cavitated_at, f.totals.cavitated, f.totals.lowest_pressure));
  if (f.stops.crowded > 0)
    list.push_back(
        fmt::format("{} contacts with stops came after a thousand others within one step and were damped "
                    "critically: give the limits more play, a restitution below 1 or less stiffness",
                    f.stops.crowded));
  if (f.body_contacts && f.body_contacts->passing > 0)
    list.push_back(fmt::format(
        "in {} contacts of time stepping the shapes moved past each other within the step by more "
        "than half of that from the surface to the middle of the thinner one: such shapes may "
        "push each other though they pass beside each other; give a shorter mbd.integrator.step",
        f.body_contacts->passing));
  if (f.body_contacts && f.body_contacts->turning > 0)
    list.push_back(fmt::format(
        "in {} contacts of time stepping a shape that is no sphere turned by more than 0.5 rad within the "
        "step, and pushed as it stood when the step began: give a shorter mbd.integrator.step",
        f.body_contacts->turning));
  if (f.body_contacts && f.body_contacts->dull > 0)
    list.push_back(fmt::format(
        "{} contacts of time stepping between materials with a restitution above 0.5 began in a step longer "
        "than 1/30 of the duration of their impact: they rebound with less; give a shorter "
        "mbd.integrator.step, or leave out mbd.contact.impacts",
        f.body_contacts->dull));
  // Data have digits: a start that is off by less changes nothing that shows.
  constexpr double shows = 1e-3, matters = 0.01;  // of the thinner shape; of the energy that moves
  const ReleasedAtStart& r = f.released;
  if (r.depth_share > shows && r.energy > matters * f.energy_scale)
    list.push_back(
        fmt::format("{} overlap at the start by {:.3g} m, and no load holds them: their contact throws them "
                    "apart with {:.3g} J, {:.2g} of the energy that moves in the run; move one of them",
                    f.released_by, r.depth, r.energy, r.energy / f.energy_scale));
  return list;
}

// Motors and cylinders at the end.
Json elements_of(const std::vector<ElementObservation>& elements) {
  Json list = Json::array();
  for (const ElementObservation& e : elements) {
    Json one{
        {"name", e.name}, {"coordinate", e.s}, {"rate", e.rate}, {"force", e.force}, {"power_W", e.power}};
    if (e.hydraulic) {
      one["pressures_Pa"] = {e.pressure_a, e.pressure_b};
      one["flows_m3_per_s"] = {e.flow_a, e.flow_b};
    }
    list.push_back(one);
  }
  return list;
}

}  // namespace

std::string report_facts(const RunFigures& f) {
  const EnergySums& energy = f.totals.energy;
  protocol::MbdFacts facts;
  facts.state_hash = f.state_hash;
  facts.steps = f.counters.steps;
  facts.shortened_steps = f.shortened.count;
  facts.doubtful_steps = f.shortened.doubtful;
  facts.largest_energy_balance = f.totals.largest_residual;
  facts.energy_scale = f.energy_scale;
  facts.lowest_dof = static_cast<std::uint64_t>(f.totals.fewest_freedoms);
  facts.largest_reaction = f.totals.largest_reaction;
  if (!f.most_loaded_joint.empty()) facts.most_loaded_joint = f.most_loaded_joint;
  facts.reaction_scale = f.totals.reaction_scale;
  facts.constraint_violation = f.constraint_violation;
  facts.largest_constraint_violation = f.totals.largest_violation;
  facts.local_error_sum = f.local_error_sum;
  facts.sharpest_turn = f.totals.sharpest_turn;
  facts.sharpest_turn_at = f.totals.sharpest_turn_at;
  facts.sharpest_turn_loop = f.sharpest_turn_loop;
  facts.cavitated = f.totals.cavitated;
  if (f.body_contacts) {
    facts.contact_depth = f.totals.contact_depth;
    facts.contact_depth_of = f.deepest_contact;
    facts.contact_depth_at = f.totals.contact_depth_at;
  }
  if (f.bottomed) {
    facts.tyre_bottoming = f.bottomed->share;
    facts.tyre_bottoming_of = f.bottomed->of;
    facts.tyre_bottoming_at = f.bottomed->first_time;
  }
  facts.size = f.size;
  facts.periods_per_step = f.periods_per_step;
  facts.warnings = run_warnings(f);
  facts.solver_cpu_seconds = f.solver_cpu_seconds;
  facts.solver_seconds = f.solver_seconds;
  Json others{{"mbd_newton_iterations", f.counters.newton_iterations},
              {"mbd_factorisations", f.counters.factorisations},
              {"mbd_load_jumps", f.counters.load_jumps},
              {"mbd_rejected_steps", f.counters.rejected},
              {"mbd_unresolved_steps", f.counters.unresolved},
              {"mbd_evaluations", f.counters.evaluations},
              {"mbd_stiff_steps", f.counters.stiff},
              {"mbd_stop_contacts", f.stops.contacts},
              {"mbd_stop_contact_steps", f.stops.steps},
              {"mbd_stop_contacts_settled", f.stops.settled},
              {"mbd_energy_start_J", f.start_energy},
              {"mbd_energy_end_J", f.end_energy},
              {"mbd_load_work_J", energy.particle_work},
              {"mbd_energy_drift_J", f.energy_residual},
              {"mbd_energy_balance_J", f.energy_residual},
              {"mbd_largest_energy_balance_at_s", f.totals.largest_residual_at},
              {"mbd_work_J",
               {{"particles", energy.particle_work},
                {"loads", energy.load_work},
                {"actuators", energy.actuator_work},
                {"motions", energy.motion_work}}},
              {"mbd_dissipated_J", energy.dissipated},
              {"mbd_dof_end", f.degrees_of_freedom}};
  if (f.body_contacts) {
    others["mbd_body_contacts"] = f.body_contacts->contacts;
    others["mbd_body_contact_steps"] = f.body_contacts->steps;
    others["mbd_contact_unsettled_steps"] = f.body_contacts->unsettled;
    others["mbd_contact_dissipated_J"] = f.totals.contact_loss;
    others["mbd_largest_contact_force_N"] = f.totals.contact_force;
    others["mbd_largest_contact_force_at_s"] = f.totals.contact_force_at;
  }
  if (!f.elements.empty()) others["mbd_elements_end"] = elements_of(f.elements);
  add_error_facts(f.error, facts, others);
  return protocol::encode_facts(facts, others);
}

}  // namespace tandem::mbd
