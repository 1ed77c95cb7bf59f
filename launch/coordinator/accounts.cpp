#include "launch/coordinator/accounts.hpp"

#include <algorithm>
#include <cmath>

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

// Work of a constant force and torque on the way from one pose to the other [J].
double work(const Wrench& load, const Pose& from, const Pose& to) {
  return dot(load.force, to.p_WB - from.p_WB) +
         dot(load.torque, rotation_vector(to.q_WB * from.q_WB.conjugate()));
}

void add(Wrench& sum, const Wrench& value, double factor) {
  sum.force += factor * value.force;
  sum.torque += factor * value.torque;
}

double ratio(double part, double whole) {
  return whole > 0 ? part / whole : 0;
}

}  // namespace

void Accounts::book(const Exchange& exchange) {
  ++windows_;
  const double H = exchange.load.window.length();

  for (const BodyMotion& motion : exchange.motion.bodies) {
    Impulse& impulse = impulses_[motion.body];
    const BodyLoad* booked = record_of(exchange.load.bodies, motion.body);
    add(impulse.applied, motion.applied_impulse, 1);
    if (booked) {
      add(impulse.booked, booked->mean, H);
      impulse.force += H * norm(booked->mean.force);
      impulse.torque += H * norm(booked->mean.torque);
    }
    // Held: what is booked in this window reaches the body in the next one.
    impulse.under_way = {};
    if (booked && exchange.held) add(impulse.under_way, booked->mean, H);

    double given = booked ? booked->work : 0;
    // Where the bodies did not end where the particles had been led, the particles find them moved at the
    // start of the next window: their load of the last micro step does that work.
    if (const BodyMotion* path = booked ? record_of(exchange.path.bodies, motion.body) : nullptr)
      given += work(booked->end, path->end_pose, motion.end_pose);
    energy_created_ += motion.applied_work - given;
    energy_exchanged_ += std::max(std::abs(motion.applied_work), std::abs(given));
  }

  if (exchange.load.account.micro_steps == 0) return;  // no particles
  particles_ = exchange.load.account;
  micro_steps_ += particles_.micro_steps;
  Vec3d reactions;  // of the bodies and the ground on the particles [N s]
  for (const BodyLoad& load : exchange.load.bodies) reactions += -H * load.mean.force;
  const Vec3d change = particles_.momentum_end - particles_.momentum_begin;
  momentum_error_ += change + particles_.lost_momentum - particles_.gravity_impulse - reactions;
  momentum_scale_[0] += norm(change);
  momentum_scale_[1] += norm(particles_.gravity_impulse);
  momentum_scale_[2] += norm(reactions);
}

double Accounts::impulse_closure() const {
  double worst = 0;
  for (const auto& [body, impulse] : impulses_) {
    const Vec3d force = impulse.booked.force - impulse.applied.force - impulse.under_way.force;
    const Vec3d torque = impulse.booked.torque - impulse.applied.torque - impulse.under_way.torque;
    worst = std::max({worst, ratio(norm(force), impulse.force), ratio(norm(torque), impulse.torque)});
  }
  return worst;
}

double Accounts::energy_residual() const {
  return ratio(energy_created_, energy_exchanged_);
}

double Accounts::momentum_balance() const {
  return ratio(norm(momentum_error_),
               *std::max_element(std::begin(momentum_scale_), std::end(momentum_scale_)));
}

}  // namespace tandem::launch
