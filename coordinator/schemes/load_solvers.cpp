#include "coordinator/schemes/load_solvers.hpp"

#include <algorithm>
#include <map>

#include "coordinator/schemes/exchange.hpp"

namespace tandem::launch {
namespace {

void add(const Wrench& from, Wrench& to) {
  to.force += from.force;
  to.torque += from.torque;
}

void add(const protocol::BodyLoad& from, protocol::BodyLoad& to) {
  add(from.mean, to.mean);
  add(from.first_moment, to.first_moment);
  add(from.end, to.end);
  to.work += from.work;
}

void add(const protocol::ParticleAccount& from, protocol::ParticleAccount& to) {
  if (from.micro_step > to.micro_step) {
    to.micro_step = from.micro_step;
    to.micro_steps = from.micro_steps;
  }
  to.momentum_begin += from.momentum_begin;
  to.momentum_end += from.momentum_end;
  to.gravity_impulse += from.gravity_impulse;
  to.lost_momentum += from.lost_momentum;
  to.kinetic_energy += from.kinetic_energy;
  to.max_overlap_ratio = std::max(to.max_overlap_ratio, from.max_overlap_ratio);
  to.lost_particles += from.lost_particles;
  to.contacts += from.contacts;
  to.rebuilds += from.rebuilds;
}

}  // namespace

protocol::Remote* Solvers::of(protocol::Role role) const {
  if (role == protocol::Role::mbd) return mbd;
  const auto found =
      std::ranges::find_if(loads, [role](const protocol::Remote* solver) { return solver->role() == role; });
  return found == loads.end() ? nullptr : *found;
}

void start_loads(const Solvers& solvers, const protocol::MotionSet& path) {
  for (protocol::Remote* solver : solvers.loads) solver->start_advance(path);
}

void finish_loads(const Solvers& solvers, Exchange& exchange) {
  exchange.parts.clear();
  if (solvers.loads.size() == 1) {
    exchange.load = solvers.loads.front()->finish_load();
    return;
  }
  for (protocol::Remote* solver : solvers.loads) exchange.parts.push_back(solver->finish_load());
  exchange.load = sum_of(exchange.parts);
}

void save_loads(const Solvers& solvers) {
  for (protocol::Remote* solver : solvers.loads) solver->save();
}

void restore_loads(const Solvers& solvers) {
  for (protocol::Remote* solver : solvers.loads) solver->restore();
}

bool any_linearises(const Solvers& solvers) {
  return std::ranges::any_of(
      solvers.loads, [](const protocol::Remote* solver) { return solver->can(protocol::can_linearise); });
}

std::vector<protocol::BodyResponse> responses_of(const Solvers& solvers) {
  for (protocol::Remote* solver : solvers.loads)
    if (solver->can(protocol::can_respond)) return solver->linearise().responses;
  return {};
}

protocol::TangentSet linearise_loads(const Solvers& solvers) {
  protocol::TangentSet sum;
  for (protocol::Remote* solver : solvers.loads) {
    if (!solver->can(protocol::can_linearise)) continue;
    const protocol::TangentSet& part = solver->linearise();
    if (sum.bodies.empty() && sum.responses.empty()) {
      sum = part;
      continue;
    }
    for (const protocol::BodyTangent& tangent : part.bodies) {
      const auto same = std::ranges::find(sum.bodies, tangent.body, &protocol::BodyTangent::body);
      if (same == sum.bodies.end()) {
        sum.bodies.push_back(tangent);
        continue;
      }
      for (std::size_t i = 0; i < tangent.stiffness.size(); ++i) {
        same->stiffness[i] += tangent.stiffness[i];
        same->damping[i] += tangent.damping[i];
      }
    }
    // One solver at most has a liquid.
    sum.responses.insert(sum.responses.end(), part.responses.begin(), part.responses.end());
  }
  return sum;
}

protocol::LoadSet sum_of(std::span<const protocol::LoadSet> loads) {
  protocol::LoadSet sum;
  std::map<std::uint32_t, protocol::BodyLoad> bodies;
  for (const protocol::LoadSet& load : loads) {
    sum.window = load.window;
    add(load.account, sum.account);
    sum.sensors.insert(sum.sensors.end(), load.sensors.begin(), load.sensors.end());
    for (const protocol::BodyLoad& body : load.bodies) {
      const auto [known, is_new] = bodies.emplace(body.body, body);
      if (!is_new) add(body, known->second);
    }
  }
  for (const auto& [index, body] : bodies) sum.bodies.push_back(body);
  return sum;
}

}  // namespace tandem::launch
