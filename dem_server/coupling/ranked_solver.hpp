// The particle solver on several ranks (particles/base/ranks.hpp). To the coordinator it stays one
// participant: rank 0 receives the orders, and passes each on, so that all ranks execute the same orders on
// solvers that get the same arguments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "dem_server/laws/particle_names.hpp"
#include "particles/base/ranks.hpp"
#include "protocol/codec.hpp"
#include "protocol/participant/solver.hpp"

namespace tandem::dem {

// The solver of rank 0.
class LeadingSolver final : public protocol::LoadSolver {
 public:
  LeadingSolver(Ranks& ranks, std::unique_ptr<protocol::LoadSolver> own);
  // Lets the other ranks leave, or ends them where they may wait in the middle of an order.
  ~LeadingSolver() override;
  LeadingSolver(const LeadingSolver&) = delete;
  LeadingSolver& operator=(const LeadingSolver&) = delete;

  std::uint64_t capabilities() const override { return own_->capabilities(); }
  protocol::Configured configure(const protocol::Configuration& configuration) override;
  const protocol::LoadSet& advance(const protocol::MotionSet& motion) override;
  const protocol::TangentSet& linearise() override;
  const protocol::ParticlesFrame& observe() override;
  void snapshot() override;
  const protocol::ParticlesFrame& read_snapshot() override;
  void save() override;
  void restore() override;
  void checkpoint(const protocol::Checkpoint& file) override;
  void resume(const protocol::Checkpoint& file) override;
  protocol::Report report() override;

 private:
  template <class Call>
  decltype(auto) on_all(Call call);

  Ranks& ranks_;
  std::unique_ptr<protocol::LoadSolver> own_;
  protocol::Bytes order_, argument_;
  bool apart_ = false;  // an order has failed on this rank alone
};

// Error{usage} where the programs of the ranks, given by their digests, are not the same. Collective.
void expect_same_program(Ranks& ranks, std::uint64_t digest);

// A sentence where so few spheres are probably faster on one GPU than on several, else nothing.
std::string warn_of_few_spheres(std::size_t spheres, unsigned gpus);

// Executes the orders of rank 0 until it lets this rank leave. Ends all ranks where this one alone cannot
// continue; the log says why.
void follow(Ranks& ranks, protocol::LoadSolver& own);

}  // namespace tandem::dem
