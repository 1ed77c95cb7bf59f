// Sums and extremes over a run. They are saved and restored with its state on disk.
#pragma once

#include <cstdint>
#include <vector>

#include "mbd_server/forces/energy_sums.hpp"

namespace tandem::mbd {

// Of each tyre, at the ends of steps (tyres; empty: see io/tyre_bottoming.hpp).
struct TyreTotals {
  // Time in contact with the road, time of it in which a shape on the wheel bore load on the same ground, the
  // first instant of that [s], and the shape then; -1: none.
  std::vector<double> time, bottomed, bottomed_at, bottomed_shape;
};

struct RunTotals {
  EnergySums energy;
  // Of each coordinate, as increments from the start: sum of the sizes of the local errors of all steps of
  // fixed length, least and largest value at the ends of steps (freedoms) [rad or m].
  std::vector<double> local_errors, least, most;
  // The part of `local_errors` of steps between breaks of functions of time that are close to each other.
  std::vector<double> short_step_errors;
  // Number of steps between breaks, not so close, which cut the steps of repetitions; not saved.
  std::uint64_t steps_between_breaks = 0;
  double largest_residual = 0,
         largest_residual_at = 0;  // of the energy balance at the end of a step [J], [s]
  double cubed_steps = 0;          // sum of the cubes of the lengths of all steps [s3]
  double largest_violation = 0;    // of the constraints at the end of a window [-]
  // Largest curvature of the motion at the end of a step near a singular position of a loop [1/rad], [s].
  double sharpest_turn = 0, sharpest_turn_at = 0;
  double sharpest_turn_closure = -1;  // index in the model; -1: none
  double fewest_freedoms = 0;         // degrees of freedom at the end of a window
  // At output instants: largest reaction of a joint, and force scale of the machine (observation.hpp).
  double largest_reaction = 0, reaction_scale = 0;  // [N]
  double largest_reaction_joint = -1;               // index in the scene; -1: none
  // Of hydraulic cylinders, at the ends of steps: time below the cavitation pressure, first instant of it,
  // lowest pressure there, and element of the model [s], [s], [Pa]; -1: none.
  double cavitated = 0, cavitated_at = 0, lowest_pressure = 0, cavitated_element = -1;
  // Of contacts between bodies, at the ends of steps: dissipated energy, largest normal force of a point,
  // largest depth over that from the surface to the middle of the thinner shape, instants, and shapes of that
  // depth [J], [N], [-], [s]; -1: none.
  double contact_loss = 0, contact_force = 0, contact_force_at = 0;
  double contact_depth = 0, contact_depth_at = 0, contact_depth_a = -1, contact_depth_b = -1;
  // Their impulse on each boundary body since the start: torque about its centre of mass and force, world
  // axes [N m s], [N s] (6 for each boundary body; empty without mbd.contact).
  std::vector<double> contact_impulses;
  TyreTotals tyres;
};

// Calls f(name, value) for every number; `totals` is a RunTotals or const RunTotals.
template <class AnyTotals, class F>
void for_each_total(AnyTotals& totals, F&& f) {
  f("particle_work", totals.energy.particle_work);
  f("load_work", totals.energy.load_work);
  f("actuator_work", totals.energy.actuator_work);
  f("motion_work", totals.energy.motion_work);
  f("dissipated", totals.energy.dissipated);
  f("turnover", totals.energy.turnover);
  f("kinetic", totals.energy.kinetic);
  f("largest_kinetic", totals.energy.largest_kinetic);
  f("largest_residual", totals.largest_residual);
  f("largest_residual_at", totals.largest_residual_at);
  f("cubed_steps", totals.cubed_steps);
  f("largest_violation", totals.largest_violation);
  f("sharpest_turn", totals.sharpest_turn);
  f("sharpest_turn_at", totals.sharpest_turn_at);
  f("sharpest_turn_closure", totals.sharpest_turn_closure);
  f("fewest_freedoms", totals.fewest_freedoms);
  f("largest_reaction", totals.largest_reaction);
  f("reaction_scale", totals.reaction_scale);
  f("largest_reaction_joint", totals.largest_reaction_joint);
  f("cavitated", totals.cavitated);
  f("cavitated_at", totals.cavitated_at);
  f("lowest_pressure", totals.lowest_pressure);
  f("cavitated_element", totals.cavitated_element);
  f("contact_loss", totals.contact_loss);
  f("contact_force", totals.contact_force);
  f("contact_force_at", totals.contact_force_at);
  f("contact_depth", totals.contact_depth);
  f("contact_depth_at", totals.contact_depth_at);
  f("contact_depth_a", totals.contact_depth_a);
  f("contact_depth_b", totals.contact_depth_b);
}

// Calls f(name, values) for the coordinates, the shares of the elements, the impulses of contacts, and the
// tyres.
template <class AnyTotals, class F>
void for_each_list(AnyTotals& totals, F&& f) {
  f("local_errors", totals.local_errors);
  f("short_step_errors", totals.short_step_errors);
  f("least", totals.least);
  f("most", totals.most);
  f("work_of", totals.energy.work_of);
  f("lost_of", totals.energy.lost_of);
  f("contact_impulses", totals.contact_impulses);
  f("tyre_time", totals.tyres.time);
  f("tyre_bottomed", totals.tyres.bottomed);
  f("tyre_bottomed_at", totals.tyres.bottomed_at);
  f("tyre_bottomed_shape", totals.tyres.bottomed_shape);
}

}  // namespace tandem::mbd
