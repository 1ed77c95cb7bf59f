// The load solvers of a run, of grains, of a liquid or several of them, as one: each gets the same motion,
// and their loads add up.
#pragma once

#include <span>
#include <vector>

#include "protocol/messages.hpp"
#include "protocol/remote.hpp"

namespace tandem::launch {

// The solvers of a run; a solver that the scene does not need is absent.
struct Solvers {
  protocol::Remote* mbd = nullptr;
  std::vector<protocol::Remote*> loads = {};  // at most one of each role, in the order of the roles

  // Null where the run has none.
  protocol::Remote* of(protocol::Role role) const;
};

struct Exchange;

// Each load solver advances along the path; their loads are in `exchange` after finish_loads().
void start_loads(const Solvers& solvers, const protocol::MotionSet& path);
void finish_loads(const Solvers& solvers, Exchange& exchange);
void save_loads(const Solvers& solvers);
void restore_loads(const Solvers& solvers);
// The sum of the tangents of all load solvers that have some.
bool any_linearises(const Solvers& solvers);
// Of the first one that has any, also before the first window.
std::vector<protocol::BodyResponse> responses_of(const Solvers& solvers);
protocol::TangentSet linearise_loads(const Solvers& solvers);

// The loads of several solvers over one window, which all of them have. Bodies in ascending order, the values
// of sensors one after the other. The account is that of all particles together: sums, but the largest
// overlap, and number and length of micro steps of the solver with the longest ones.
protocol::LoadSet sum_of(std::span<const protocol::LoadSet> loads);

}  // namespace tandem::launch
