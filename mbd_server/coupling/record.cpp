// What the multibody solver records of each step: impulses on the boundary bodies and work on them, the
// energy balance, extremes.
#include "mbd_server/coupling/mbd_solver.hpp"

#include <algorithm>
#include <cmath>

#include "mbd_server/forces/hydraulics.hpp"

namespace tandem::mbd {

void MbdSolver::record_begin_motion() {
  for (std::size_t k = 0; k < motion_.bodies.size(); ++k) {
    before_[k] = observe_body(machine_->model, machine_->system.links(), machine_->model.boundary[k]);
    protocol::BodyMotion& motion = motion_.bodies[k] = {};
    motion.body = static_cast<std::uint32_t>(machine_->model.boundary[k]);
    motion.begin_pose = before_[k].pose;
    motion.begin_twist = before_[k].twist;
    motion.begin_a = before_[k].a;
    motion.begin_alpha = before_[k].alpha;
  }
}

void MbdSolver::record_end_motion() {
  for (std::size_t k = 0; k < motion_.bodies.size(); ++k) {
    const BodyMotionState end =
        observe_body(machine_->model, machine_->system.links(), machine_->model.boundary[k]);
    protocol::BodyMotion& motion = motion_.bodies[k];
    motion.end_pose = end.pose;
    motion.end_twist = end.twist;
    motion.end_a = end.a;
    motion.end_alpha = end.alpha;
  }
}

// Adds the impulse and the work of this step's load, of length h, on each boundary body. Over a step both
// velocity and load are linear in time: the work is that of the mean load along the displacement, plus h^2/12
// times the product of their rates.
void MbdSolver::record_step(double h) {
  for (std::size_t k = 0; k < motion_.bodies.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const Vector6d rate = state_.load_rates.col(column), load = state_.load(column) - (0.5 * h) * rate;
    const Vec3d torque = to_vec3(load.head<3>()), force = to_vec3(load.tail<3>());
    const BodyMotionState now =
        observe_body(machine_->model, machine_->system.links(), machine_->model.boundary[k]);
    const BodyMotionState& last = before_[k];
    protocol::BodyMotion& motion = motion_.bodies[k];
    motion.applied_impulse.force += h * force;
    motion.applied_impulse.torque += h * torque;
    const double along_rates = dot(to_vec3(rate.tail<3>()), now.twist.v_WB - last.twist.v_WB) +
                               dot(to_vec3(rate.head<3>()), now.twist.w_WB - last.twist.w_WB);
    const double work = dot(force, now.pose.p_WB - last.pose.p_WB) +
                        dot(torque, rotation_vector(now.pose.q_WB * last.pose.q_WB.conjugate())) +
                        h * h / 12 * along_rates;
    motion.applied_work += work;
    totals_.energy.add(&EnergySums::particle_work, work);
    before_[k] = now;
  }
  // Steps in parts, those of an error control and the mean of two runs do not go by the trapezoidal rule.
  const bool sudden =
      between_close_breaks_ && !control_ && sums_local_errors() && !machine_->method.error_of_parts();
  if (machine_->time_stepping.apply())
    record_time_step();
  else
    machine_->balance.add_step(state_, machine_->system, h, sudden, totals_.energy);
  machine_->contacts.take_lost(
      [this](double energy, int account) { totals_.energy.add(&EnergySums::dissipated, energy, account); });
  if (!machine_->model.contact.empty()) record_contacts();
  machine_->bottoming.add_step(state_, machine_->system.links(), h, totals_.tyres);
  totals_.cubed_steps += h * h * h;
  totals_.steps_between_breaks += between_breaks_;
  if (sums_local_errors())
    for (std::size_t i = 0; i < totals_.local_errors.size(); ++i) {
      totals_.local_errors[i] += local_error_[static_cast<Eigen::Index>(i)];
      if (between_close_breaks_) totals_.short_step_errors[i] += local_error_[static_cast<Eigen::Index>(i)];
    }
  record_travel();
  watch_energy();
  record_turn();
  if (state_.z.size() > 0) record_cavitation(h);
}

// Motions and surfaces work by the impulses of a step, and there are no other forces.
void MbdSolver::record_time_step() {
  const Machine& m = *machine_;
  EnergySums& energy = totals_.energy;
  const TimeStepAccount& account = m.time_stepping.account();
  for (std::size_t i = 0; i < m.model.links.size(); ++i)
    if (m.model.links[i].motion != none)
      energy.add(&EnergySums::motion_work, account.motion_work[i], m.model.links[i].account);
  energy.add(&EnergySums::motion_work, account.surface_work);
  energy.largest_kinetic = std::max(energy.largest_kinetic, m.system.kinetic_energy());
}

void MbdSolver::record_contacts() {
  const double lost = machine_->touching.take_lost();
  totals_.energy.add(&EnergySums::dissipated, lost);
  totals_.contact_loss += lost;
  machine_->touching.take_lost_of_outputs([this](double energy, int account) {
    totals_.energy.lost_of[static_cast<std::size_t>(account)] += energy;
  });
  const auto& impulses = machine_->touching.impulses();
  for (Eigen::Index i = 0; i < impulses.size(); ++i)
    totals_.contact_impulses[static_cast<std::size_t>(i)] += impulses.data()[i];
  const ContactExtremes& now = machine_->touching.extremes();
  if (now.force > totals_.contact_force)
    totals_.contact_force = now.force, totals_.contact_force_at = state_.time;
  if (now.depth_share > totals_.contact_depth) {
    totals_.contact_depth = now.depth_share, totals_.contact_depth_at = state_.time;
    totals_.contact_depth_a = now.shape_a, totals_.contact_depth_b = now.shape_b;
  }
}

// Work of the impulses that prescribed rates give where they jump. Where several jump at one instant, the
// elements share it equally.
void MbdSolver::record_jump(double energy) {
  totals_.energy.add(&EnergySums::motion_work, energy);
  const auto jumps = [&](std::size_t k) {
    return machine_->system.links()[prescribed_[k]].coordinate.rate != rates_before_[k];
  };
  int count = 0;
  for (std::size_t k = 0; k < prescribed_.size(); ++k) count += jumps(k);
  for (std::size_t k = 0; k < prescribed_.size(); ++k)
    if (jumps(k))
      totals_.energy.work_of[static_cast<std::size_t>(machine_->model.links[prescribed_[k]].account)] +=
          energy / count;
}

// Oil that boils has another law: the pressures are marked, not corrected.
void MbdSolver::record_cavitation(double h) {
  double lowest = 0;
  bool below = false;
  for (std::size_t i = 0; i < machine_->machine_elements.size(); ++i) {
    const Element& e = *machine_->machine_elements[i];
    const auto* oil = e.law_as<Hydraulics>();
    if (!oil) continue;
    const double pressure = std::min(state_.z[e.state], state_.z[e.state + 1]);
    if (pressure >= oil->cavitation) continue;
    if (totals_.cavitated_element < 0)
      totals_.cavitated_at = state_.time, totals_.cavitated_element = static_cast<double>(i);
    lowest = std::min(lowest, pressure);
    below = true;
  }
  if (!below) return;
  totals_.lowest_pressure = std::min(totals_.lowest_pressure, lowest);
  totals_.cavitated += h;
}

// A stiff spring that accelerates its mass in one step may slow it down in the next: a step that changes the
// energy much is compared by itself, other steps are compared window by window.
void MbdSolver::watch_energy() {
  constexpr double much = 1e-2;  // share of the largest kinetic energy
  const double kinetic = machine_->system.kinetic_energy();
  if (std::abs(kinetic - totals_.energy.kinetic) > much * totals_.energy.largest_kinetic) record_energy();
  totals_.energy.kinetic = kinetic;
}

void MbdSolver::record_energy() {
  const Machine& m = *machine_;
  const double residual =
      energy_residual(m.system.kinetic_energy() + potential_energy(m.model, state_, m.system.links()));
  if (std::abs(residual) <= std::abs(totals_.largest_residual)) return;
  totals_.largest_residual = residual;
  totals_.largest_residual_at = state_.time;
}

// Extrapolation removes their leading term, and the explicit method has others.
bool MbdSolver::sums_local_errors() const {
  return !machine_->extrapolation && !machine_->explicit_method && !machine_->time_stepping.apply();
}

// Estimates the local error as the error control does (generalized_alpha.hpp), from the rate of the
// acceleration over this step: a contact that begins at its end has another rate. Where the step was taken in
// parts, that rate is only of the last part.
void MbdSolver::measure_local_error(double h) {
  if (!sums_local_errors()) return;
  const GeneralizedAlpha& method = machine_->method;
  if (method.error_of_parts())
    local_error_ = method.errors_of_parts();
  else
    local_error_ = (error_constant_ * h * h * h) * state_.udot_rate.cwiseAbs();
}

double MbdSolver::energy_residual(double energy) const {
  return energy - start_energy_ - totals_.energy.work() + totals_.energy.dissipated;
}

// Scale for a residual of the energy balance: the kinetic energy or the energy transferred. Where next to
// nothing moves, the scale is 1e-9 of three energies: weight times size of the machine, its kinetic energy at
// one size per run time, and the energy stored in springs. Round-off is far below it, motion far above.
double MbdSolver::energy_scale() const {
  const Machine& m = *machine_;
  const double speed = state_.time > 0 ? m.model.size / state_.time : 0;
  double mass = 0, weight = 0;
  for (const BodyOnLink& body : m.model.bodies) {
    mass += body.mass;
    weight += body.mass * m.model.gravity.dot(m.model.origin + m.system.links()[body.link].point(body.p_LB));
  }
  const double stored = std::abs(potential_energy(m.model, state_, m.system.links()) + weight);
  const double least = 1e-9 * (mass * (m.model.gravity.norm() * m.model.size + speed * speed) + stored);
  return std::max({totals_.energy.largest_kinetic, totals_.energy.turnover, least});
}

// Where two branches of a loop's motion cross, data of a few digits make one branch bend into the other: the
// path is a hyperbola, whose curvature is about the inverse of the sine between the branches. A machine that
// hardly moves has a large curvature for other reasons and is left out.
void MbdSolver::record_turn() {
  constexpr double moving = 1e-3;  // share of the largest kinetic energy
  const Machine& m = *machine_;
  if (m.model.equations == 0 || m.system.elimination().smallest_sine() > std::sqrt(tolerance_)) return;
  if (m.system.kinetic_energy() < moving * energy_scale()) return;
  const double turn = m.system.curvature(state_);
  if (turn <= totals_.sharpest_turn) return;
  totals_.sharpest_turn = turn;
  totals_.sharpest_turn_at = state_.time;
  totals_.sharpest_turn_closure = m.system.elimination().tightest_closure();
}

void MbdSolver::record_window() {
  const Machine& m = *machine_;
  record_energy();
  totals_.largest_violation = std::max(totals_.largest_violation, constraint_violation(m.model, m.system));
  totals_.fewest_freedoms = std::min(totals_.fewest_freedoms, static_cast<double>(m.degrees_of_freedom()));
}

void MbdSolver::record_reactions(const std::vector<JointObservation>& joints) {
  const Machine& m = *machine_;
  totals_.reaction_scale = std::max(totals_.reaction_scale, force_scale(m.model, state_, m.system.links()));
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Wrench& reaction = joints[j].reaction;
    const double size = std::max(norm(reaction.force), norm(reaction.torque) / m.model.size);
    if (size <= totals_.largest_reaction) continue;
    totals_.largest_reaction = size;
    totals_.largest_reaction_joint = static_cast<double>(j);
  }
}

}  // namespace tandem::mbd
