// The loads of several solvers as one.
#include "coordinator/schemes/load_solvers.hpp"

#include <gtest/gtest.h>

#include "coordinator/schemes/schemes.hpp"

namespace tandem::launch {
namespace {

using protocol::LoadSet;

LoadSet load(std::uint32_t body, double force, double micro_step, std::uint64_t micro_steps) {
  LoadSet set;
  set.window = {3, Nanoseconds{1000}, Nanoseconds{2000}};
  protocol::BodyLoad& of_body = set.bodies.emplace_back();
  of_body.body = body;
  of_body.mean.force = of_body.end.force = {force, 0, 0};
  of_body.mean.torque = {0, force, 0};
  of_body.first_moment.force = {0, 0, force};
  of_body.work = 2 * force;
  set.account.micro_step = micro_step;
  set.account.micro_steps = micro_steps;
  set.account.momentum_end = {force, 0, 0};
  set.account.kinetic_energy = force;
  return set;
}

TEST(LoadSolvers, LoadsAddUpBodyByBody) {
  LoadSet grains = load(4, 1, 1e-5, 100), liquid = load(4, 10, 1e-4, 10);
  grains.bodies.push_back(load(ground.value, 5, 0, 0).bodies[0]);
  liquid.bodies.insert(liquid.bodies.begin(), load(2, 7, 0, 0).bodies[0]);
  grains.sensors = {1.5, 2.5};
  const LoadSet sum = sum_of(std::vector<LoadSet>{grains, liquid});
  EXPECT_EQ(sum.window.index, 3u);
  EXPECT_EQ(sum.window.end.count, 2000);
  ASSERT_EQ(sum.bodies.size(), 3u);
  EXPECT_EQ(sum.bodies[0].body, 2u);
  EXPECT_EQ(sum.bodies[0].mean.force.x, 7);
  EXPECT_EQ(sum.bodies[1].body, 4u);
  EXPECT_EQ(sum.bodies[1].mean.force.x, 11);
  EXPECT_EQ(sum.bodies[1].mean.torque.y, 11);
  EXPECT_EQ(sum.bodies[1].first_moment.force.z, 11);
  EXPECT_EQ(sum.bodies[1].end.force.x, 11);
  EXPECT_EQ(sum.bodies[1].work, 22);
  EXPECT_EQ(sum.bodies[2].body, ground.value);
  EXPECT_EQ(sum.sensors, (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(sum.account.momentum_end.x, 11);
  EXPECT_EQ(sum.account.kinetic_energy, 11);
  EXPECT_EQ(sum.account.micro_step, 1e-4);
  EXPECT_EQ(sum.account.micro_steps, 10u);
}

// With one solver the load is that of the solver, to the bit and in its order.
TEST(LoadSolvers, OneSolverHasNoParts) {
  Exchange exchange;
  exchange.load = load(4, 1, 1e-5, 100);
  ASSERT_EQ(exchange.loads().size(), 1u);
  EXPECT_EQ(&exchange.loads()[0], &exchange.load);
  exchange.parts = {load(4, 1, 1e-5, 100), load(4, 2, 1e-4, 10)};
  ASSERT_EQ(exchange.loads().size(), 2u);
  EXPECT_EQ(exchange.loads()[1].bodies[0].mean.force.x, 2);
}

}  // namespace
}  // namespace tandem::launch
