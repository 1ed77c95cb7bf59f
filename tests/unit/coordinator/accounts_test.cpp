#include "coordinator/accounts/accounts.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/unit/coordinator/fake_solvers.hpp"

namespace tandem::launch {
namespace {

using test::ExplicitStep;
using test::PointMass;
using test::Session;
using test::WallContact;

Accounts run(ExplicitStep step, int windows) {
  PointMass mass(2);
  WallContact wall;
  wall.k = 50;
  wall.d = 1;
  mass.x = 0.1;
  Session session(mass, wall);
  Accounts accounts;
  for (int i = 0; i < windows; ++i) {
    session.advance(step, 0.01);
    accounts.record(session.exchange);
  }
  return accounts;
}

TEST(Accounts, ImpulseClosesToRoundOffInEveryScheme) {
  for (const ExplicitStep step : {parallel, mbd_first, dem_first}) {
    const double closure = run(step, 500).impulse_closure();
    std::printf("  impulse closure %.3e, tolerance 1e-14\n", closure);
    EXPECT_LE(closure, 1e-14);
  }
}

// Without damping, the energy created by the coupling is the total gain of mass and spring.
TEST(Accounts, EnergyCreatedIsTheGainOfMassAndSpring) {
  for (const ExplicitStep step : {mbd_first, dem_first, parallel}) {
    PointMass mass(2);
    WallContact wall;
    wall.k = 50;  // omega H = 0.05
    mass.x = 0.1;
    const auto energy = [&] { return mass.mass * mass.v * mass.v / 2 + wall.k * mass.x * mass.x / 2; };
    const double begin = energy();
    Session session(mass, wall);
    Accounts accounts;
    for (int i = 0; i < 137; ++i) {
      session.advance(step, 0.01);
      accounts.record(session.exchange);
    }
    const double gained = energy() - begin;
    std::printf("  energy gained %.6e J, recorded as created %.6e J, exchanged %.3e J\n", gained,
                accounts.energy_created(), accounts.energy_exchanged());
    // The displacement between two windows counts with the load before it:
    // an error of k (a H^2 / 2)^2 / 2 each.
    EXPECT_NEAR(accounts.energy_created(), gained,
                step == mbd_first ? 1e-12 : 1e-4 * accounts.energy_exchanged());
  }
}

TEST(Accounts, AHeldLoadCreatesEnergyAndTheSameWindowDoesNot) {
  const double held = run(mbd_first, 500).energy_residual(),
               same_window = run(dem_first, 500).energy_residual();
  std::printf("  energy residual: mbd_first %.3e, dem_first %.3e\n", held, same_window);
  EXPECT_GT(held, 0.01);
  EXPECT_LT(std::abs(same_window), held / 10);
}

TEST(Accounts, ALostImpulseIsSeen) {
  Exchange exchange;
  exchange.load.window = {0, {0}, {1'000'000}};
  exchange.load.bodies.resize(1);
  exchange.load.bodies[0].mean.force = {0, 0, 100};
  exchange.applied = exchange.load;
  exchange.motion.window = exchange.load.window;
  exchange.motion.bodies.resize(1);
  exchange.motion.bodies[0].applied_impulse.force = {0, 0, 0.1 * (1 - 1e-6)};
  Accounts accounts;
  accounts.record(exchange);
  EXPECT_NEAR(accounts.impulse_closure(), 1e-6, 1e-12);
}

TEST(Accounts, WhatASchemeKeepsBackIsOutstandingAndNotLost) {
  Exchange exchange;
  exchange.load.window = {0, {0}, {1'000'000}};
  exchange.load.bodies.resize(1);
  exchange.load.bodies[0].mean.force = {0, 0, 100};
  exchange.applied = exchange.load;
  exchange.applied.bodies[0].mean.force.z = 75;
  exchange.motion.window = exchange.load.window;
  exchange.motion.bodies.resize(1);
  exchange.motion.bodies[0].applied_impulse.force = {0, 0, 0.075};
  Accounts accounts;
  accounts.record(exchange);
  EXPECT_NEAR(accounts.impulse_closure(), 0, 1e-16);
  EXPECT_NEAR(accounts.impulse_outstanding(), 0.25, 1e-15);
  EXPECT_NEAR(accounts.bodies().at(0).outstanding.force.z, 0.025, 1e-17);
}

TEST(Accounts, MomentumOfTheParticlesAgainstGravityReactionsAndLosses) {
  Exchange exchange;
  exchange.load.window = {0, {0}, {1'000'000'000}};
  exchange.load.bodies.resize(1);
  exchange.load.bodies[0].mean.force = {0, 0, -6};  // on the body: the force on the particles is +6 N
  protocol::ParticleAccount& account = exchange.load.account;
  account.micro_steps = 10;
  account.gravity_impulse = {0, 0, -10};
  account.momentum_begin = {0, 0, 1};
  account.lost_momentum = {0, 0, -2};
  account.momentum_end = {0, 0, -1};  // 1 - 10 + 6 - (-2)
  Accounts accounts;
  accounts.record(exchange);
  EXPECT_NEAR(accounts.particles().momentum(), 0, 1e-15);
  EXPECT_EQ(accounts.micro_steps(), 10u);

  // The next window begins where this one has ended.
  account.momentum_begin = {0, 0, -1};
  account.momentum_end = {0, 0, -3};
  accounts.record(exchange);
  EXPECT_NEAR(accounts.particles().momentum(), 0, 1e-15);
  EXPECT_NEAR(accounts.particles().momentum_windows(), 0, 1e-15);
}

TEST(Accounts, AMomentumThatJumpsBetweenWindowsIsSeen) {
  Exchange exchange;
  exchange.load.window = {0, {0}, {1'000'000'000}};
  protocol::ParticleAccount& account = exchange.load.account;
  account.micro_steps = 10;
  account.micro_step = 0.1;
  account.gravity_impulse = account.momentum_end = {0, 0, -10};
  Accounts accounts;
  accounts.record(exchange);
  EXPECT_EQ(accounts.particles().momentum(), 0);
  EXPECT_EQ(accounts.particles().largest_micro_step(), 0.1);
  account.momentum_begin = {0, 0, -9};
  account.momentum_end = {0, 0, -19};
  accounts.record(exchange);
  EXPECT_NEAR(accounts.particles().momentum(), 1.0 / 20, 1e-15);
}

TEST(Accounts, MomentumThatNothingExplainsIsRelativeToTheLargestImpulse) {
  Exchange exchange;
  exchange.load.window = {0, {0}, {1'000'000'000}};
  protocol::ParticleAccount& account = exchange.load.account;
  account.micro_steps = 10;
  Accounts accounts;
  account.gravity_impulse = {0, 0, -10};
  account.momentum_end = {0, 0, -10};
  accounts.record(exchange);
  account.momentum_begin = {0, 0, -10};
  account.momentum_end = {0, 0, -19.5};
  accounts.record(exchange);
  EXPECT_NEAR(accounts.particles().momentum(), 0.5 / 20, 1e-15)
      << "relative to the largest: gravity in two windows";
  EXPECT_FALSE(accounts.coupled()) << "no body takes part";
}

}  // namespace
}  // namespace tandem::launch
