// What the solver observes and reports.
#include <algorithm>
#include <cmath>

#include "mbd_server/coupling/facts.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"

namespace tandem::mbd {

const protocol::BodiesFrame& MbdSolver::observe() {
  Machine& m = *machine_;
  m.system.residual(state_);
  const auto& links = m.system.links();
  frame_.time = to_nanoseconds(state_.time);
  for (std::size_t b = 0; b < frame_.bodies.size(); ++b) {
    const BodyMotionState seen = observe_body(m.model, links, static_cast<int>(b));
    frame_.bodies[b] = {static_cast<std::uint32_t>(b), 0, seen.pose, seen.twist};
  }
  const auto& joints = m.joints.observe(state_, links);
  record_reactions(joints);
  const std::vector<Components>& undetermined = m.undetermined.find(m.system, m.redundant());
  for (std::size_t j = 0; j < joints.size(); ++j)
    frame_.joints[j] = {static_cast<std::uint32_t>(j), undetermined[j], joints[j].q, joints[j].rate,
                        joints[j].reaction};
  frame_.energy = energy(m.model, state_, links);
  m.elements.observe(state_, m.system, totals_.energy, frame_.elements);
  frame_.contacts = totals_.contact_impulses;
  if (!m.model.contact.empty()) frame_.contacts.push_back(contact_energy(m.model, state_, links));
  return frame_;
}

protocol::Report MbdSolver::report() {
  Machine& m = *machine_;
  m.system.residual(state_);
  record_reactions(m.joints.observe(state_, m.system.links()));
  const double now = energy(m.model, state_, m.system.links());
  const auto loaded = static_cast<std::ptrdiff_t>(totals_.largest_reaction_joint);
  const auto cavitated = static_cast<std::ptrdiff_t>(totals_.cavitated_element);
  const auto deepest = static_cast<int>(totals_.contact_depth_a);
  const auto turned = static_cast<std::ptrdiff_t>(totals_.sharpest_turn_closure);
  RunFigures figures{
      .state_hash = hash(state_),
      .counters = m.controlled().counters(),
      .stops = m.contacts.counters(),
      .body_contacts = m.model.contact.empty() ? std::nullopt : std::optional(m.touching.counters()),
      .shortened = m.method.shortened(),
      .solver_seconds = seconds_,
      .solver_cpu_seconds = cpu_seconds_,
      .local_error_sum = sums_local_errors() && !control_ ? std::optional(local_error_sum()) : std::nullopt,
      .constraint_violation = constraint_violation(m.model, m.system),
      .start_energy = start_energy_,
      .end_energy = now,
      .energy_residual = energy_residual(now),
      .energy_scale = energy_scale(),
      .degrees_of_freedom = m.degrees_of_freedom(),
      .size = m.model.size,
      .periods_per_step = longest_step_ * m.model.frequency,
      .unstable_start = unstable_start_,
      .most_loaded_joint = loaded < 0 ? "" : m.joint_names[static_cast<std::size_t>(loaded)],
      .sharpest_turn_loop = turned < 0 ? "" : m.model.closures[static_cast<std::size_t>(turned)].name,
      .cavitated = cavitated < 0 ? "" : m.machine_elements[static_cast<std::size_t>(cavitated)]->name,
      .deepest_contact = deepest < 0
                             ? ""
                             : m.model.contact.shape(deepest).name + " and " +
                                   m.model.contact.shape(static_cast<int>(totals_.contact_depth_b)).name,
      .bottomed = m.bottoming.longest(totals_.tyres),
      .released = m.touching.released(),
      .released_by = m.touching.released().shape_a == none
                         ? ""
                         : m.model.contact.shape(m.touching.released().shape_a).name + " and " +
                               m.model.contact.shape(m.touching.released().shape_b).name,
      .elements = observe_elements(m.model, state_, m.system.links()),
      .totals = totals_,
      .error = {}};
  figures.error = measure_error();
  return {report_facts(figures)};
}

}  // namespace tandem::mbd
