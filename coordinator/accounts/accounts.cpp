#include "coordinator/accounts/accounts.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tandem::launch {
namespace {

using protocol::BodyLoad;
using protocol::BodyMotion;

template <class Record>
const Record* record_of(const std::vector<Record>& records, std::uint32_t body) {
  const auto found = std::find_if(records.begin(), records.end(),
                                  [body](const Record& record) { return record.body == body; });
  return found == records.end() ? nullptr : &*found;
}

// Work of a constant force and torque along the displacement from one pose to the other [J].
double work(const Wrench& load, const Pose& from, const Pose& to) {
  return dot(load.force, to.p_WB - from.p_WB) +
         dot(load.torque, rotation_vector(to.q_WB * from.q_WB.conjugate()));
}

void add(Wrench& sum, const Wrench& value, double factor) {
  sum.force += factor * value.force;
  sum.torque += factor * value.torque;
}

// The byte of a bool read from a file, where it may have any value.
std::uint8_t flag(const bool& value) {
  std::uint8_t byte = 0;
  std::memcpy(&byte, &value, sizeof byte);
  return byte;
}

double ratio(double part, double whole) {
  return whole > 0 ? part / whole : 0;
}

}  // namespace

double WindowBalance::created() const {
  double sum = 0;
  for (const BodyBalance& body : bodies) sum += body.received - body.given;
  return sum;
}

double WindowBalance::exchanged() const {
  double sum = 0;
  for (const BodyBalance& body : bodies) sum += std::max(std::abs(body.received), std::abs(body.given));
  return sum;
}

WindowBalance Accounts::balance_of(const Exchange& exchange) {
  const double H = exchange.load.window.length();
  WindowBalance balance;
  for (const BodyMotion& motion : exchange.motion.bodies) {
    BodyBalance& body = balance.bodies.emplace_back();
    body.body = motion.body;
    body.applied = motion.applied_impulse;
    body.received = motion.applied_work;
    const BodyLoad* recorded = record_of(exchange.load.bodies, motion.body);
    if (!recorded) continue;
    body.loaded = true;
    add(body.recorded, recorded->mean, H);
    if (const BodyLoad* sent = record_of(exchange.applied.bodies, motion.body); sent && !exchange.held) {
      add(body.outstanding, recorded->mean, H);
      add(body.outstanding, sent->mean, -H);
    }
    body.given = recorded->work;
    // Where the bodies did not end at the end of the prescribed path, the particles see them displaced at
    // the start of the next window: their load of the last micro step does that work.
    if (const BodyMotion* path = record_of(exchange.path.bodies, motion.body))
      body.given += work(recorded->end, path->end_pose, motion.end_pose);
  }
  return balance;
}

void Accounts::record(const Exchange& exchange) {
  ++windows_;
  last_ = balance_of(exchange);
  energy_created_ += last_.created();
  energy_exchanged_ += last_.exchanged();
  for (const BodyBalance& body : last_.bodies) {
    BodyBalance& sum = bodies_[body.body];
    sum.body = body.body;
    sum.loaded |= body.loaded;
    add(sum.recorded, body.recorded, 1);
    add(sum.applied, body.applied, 1);
    add(sum.outstanding, body.outstanding, 1);
    sum.given += body.given;
    sum.received += body.received;

    Impulse& impulse = impulses_[body.body];
    impulse.force += norm(body.recorded.force);
    impulse.torque += norm(body.recorded.torque);
    // Held: the load recorded in this window acts on the body in the next one.
    impulse.under_way = exchange.held ? body.recorded : Wrench{};
  }

  const std::span<const protocol::LoadSet> loads = exchange.loads();
  if (particles_.size() < loads.size()) particles_.resize(loads.size());
  for (std::size_t i = 0; i < loads.size(); ++i) particles_[i].record(loads[i]);
}

void ParticleBalance::record(const protocol::LoadSet& load) {
  if (load.account.micro_steps == 0) return;  // no particles
  // From the end of the last window to the begin of this one nothing acts on the particles.
  const Vec3d jump = account_.micro_steps > 0 ? load.account.momentum_begin - account_.momentum_end : Vec3d{};
  account_ = load.account;
  largest_micro_step_ = std::max(largest_micro_step_, account_.micro_step);
  micro_steps_ += account_.micro_steps;
  Vec3d reactions;  // of the bodies and the ground on the particles [N s]
  for (const BodyLoad& body : load.bodies) reactions += -load.window.length() * body.mean.force;
  const Vec3d change = account_.momentum_end - account_.momentum_begin;
  const Vec3d error = jump + change + account_.lost_momentum - account_.gravity_impulse - reactions;
  error_ += error;
  error_sum_ += norm(error);
  scale_[0] += norm(change);
  scale_[1] += norm(account_.gravity_impulse);
  scale_[2] += norm(reactions);
}

void ParticleBalance::save_or_restore(Archive& archive, const std::string& prefix) {
  archive(prefix + "momentum_error", error_);
  archive(prefix + "momentum_error_sum", error_sum_);
  archive(prefix + "momentum_scale", scale_);
  archive(prefix + "micro_steps", micro_steps_);
  archive(prefix + "largest_micro_step", largest_micro_step_);
  archive(prefix + "particles", account_);
  for (const double sum : {largest_micro_step_, norm(error_), error_sum_, scale_[0], scale_[1], scale_[2]})
    archive.expect(std::isfinite(sum), "accounts", "a sum is not finite");
}

double ParticleBalance::momentum() const {
  return ratio(norm(error_), *std::max_element(std::begin(scale_), std::end(scale_)));
}

double ParticleBalance::momentum_windows() const {
  return ratio(error_sum_, *std::max_element(std::begin(scale_), std::end(scale_)));
}

const ParticleBalance& Accounts::particles(std::size_t solver) const {
  static const ParticleBalance none;
  return solver < particles_.size() ? particles_[solver] : none;
}

std::uint64_t Accounts::micro_steps() const {
  std::uint64_t all = 0;
  for (const ParticleBalance& particles : particles_) all += particles.micro_steps();
  return all;
}

double Accounts::Impulse::relative(const Wrench& part) const {
  return std::max(ratio(norm(part.force), force), ratio(norm(part.torque), torque));
}

void Accounts::save_or_restore(Archive& archive, std::size_t bodies, std::size_t load_solvers) {
  archive("accounts/last", last_.bodies);
  archive("accounts/bodies", bodies_);
  archive("accounts/impulses", impulses_);
  archive("accounts/energy_exchanged", energy_exchanged_);
  archive("accounts/energy_created", energy_created_);
  archive("accounts/windows", windows_);
  particles_.resize(load_solvers);
  for (std::size_t i = 0; i < load_solvers; ++i)
    particles_[i].save_or_restore(archive, i == 0 ? "accounts/" : "accounts/" + std::to_string(i) + "/");
  const auto expect = [&](const char* name, const BodyBalance& of) {
    archive.expect(of.body < bodies || of.body == ground.value, name, "there is no such body");
    archive.expect(flag(of.loaded) <= 1, name, "`loaded` is neither true nor false");
    for (const Wrench* wrench : {&of.recorded, &of.applied, &of.outstanding})
      archive.expect(is_finite(wrench->force) && is_finite(wrench->torque), name, "an impulse is not finite");
    archive.expect(std::isfinite(of.given) && std::isfinite(of.received), name, "a work is not finite");
  };
  for (const double sum : {energy_exchanged_, energy_created_})
    archive.expect(std::isfinite(sum), "accounts", "a sum is not finite");
  for (const BodyBalance& body : last_.bodies) expect("accounts/last", body);
  for (const auto& [index, body] : bodies_) {
    archive.expect(index < bodies, "accounts/bodies.keys", "there is no such body");
    expect("accounts/bodies.items", body);
  }
  for (const auto& [index, impulse] : impulses_)
    archive.expect(bodies_.contains(index), "accounts/impulses.keys",
                   "there is no such body in accounts/bodies");
}

double Accounts::impulse_closure() const {
  double worst = 0;
  for (const auto& [body, impulse] : impulses_) {
    const BodyBalance& sum = bodies_.at(body);
    Wrench open = sum.recorded;
    for (const Wrench& known : {sum.applied, impulse.under_way, sum.outstanding}) add(open, known, -1);
    worst = std::max(worst, impulse.relative(open));
  }
  return worst;
}

double Accounts::impulse_outstanding() const {
  double worst = 0;
  for (const auto& [body, impulse] : impulses_)
    worst = std::max(worst, impulse.relative(bodies_.at(body).outstanding));
  return worst;
}

double Accounts::energy_residual() const {
  return ratio(energy_created_, energy_exchanged_);
}

}  // namespace tandem::launch
