#include "launch/coordinator/summary.hpp"

#include <gtest/gtest.h>

namespace tandem::launch {
namespace {

using protocol::Role;

Summary empty() {
  SceneFile file;
  file.origin = "toy.json";
  file.scene.name = "toy";
  return Summary(file, {});
}

TEST(Summary, JoinsTheListsOfBothSolvers) {
  Summary summary = empty();
  summary.add_facts(Role::mbd, R"({"left_out": ["no springs"], "warnings": []})");
  summary.add_facts(Role::dem,
                    R"({"left_out": ["no friction", "no springs"], "warnings": ["fast"], "spheres": 7})");
  EXPECT_EQ(summary.json()["left_out"].dump(), R"(["no springs","no friction"])");
  EXPECT_EQ(summary.json()["warnings"].dump(), R"(["fast"])");
  EXPECT_EQ(summary.number("spheres"), 7);
}

TEST(Summary, KeepsTheSecondsOfTheSolversApart) {
  Summary summary = empty();
  summary.add_facts(Role::mbd, R"({"solver_seconds": 1.5})");
  summary.add_facts(Role::dem, R"({"solver_seconds": 2.5})");
  EXPECT_EQ(summary.number("mbd_solver_seconds"), 1.5);
  EXPECT_EQ(summary.number("dem_solver_seconds"), 2.5);
}

TEST(Summary, StateHashDependsOnBothSolvers) {
  const auto hash = [](const char* mbd, const char* dem) {
    Summary summary = empty();
    summary.add_facts(Role::mbd, mbd);
    summary.add_facts(Role::dem, dem);
    return summary.json()["state_hash"].get<std::string>();
  };
  const std::string first = hash(R"({"mbd_state_hash": "a"})", R"({"dem_state_hash": "b"})");
  EXPECT_EQ(first.size(), 16u);
  EXPECT_EQ(first, hash(R"({"mbd_state_hash": "a"})", R"({"dem_state_hash": "b"})"));
  EXPECT_NE(first, hash(R"({"mbd_state_hash": "b"})", R"({"dem_state_hash": "a"})"));
  EXPECT_NE(first, hash(R"({"mbd_state_hash": "a"})", R"({"dem_state_hash": "c"})"));
}

TEST(Summary, FactsThatAreNoObjectAreTheSendersFault) {
  Summary summary = empty();
  try {
    summary.add_facts(Role::dem, "[1]");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::protocol);
    EXPECT_EQ(error.where(), "dem_server");
  }
}

TEST(Summary, StatusDecidesTheExitStatus) {
  Summary summary = empty();
  summary.set_end(Status::ok);
  EXPECT_EQ(summary.exit_status(), 0);
  summary.set_end(Status::checks_failed);
  EXPECT_EQ(summary.exit_status(), 1);
  summary.set_end(Status::interrupted);
  EXPECT_EQ(summary.exit_status(), 130);
  const Error error(ErrorCode::numerics, "no convergence", "mbd_server", "a shorter step");
  summary.set_end(Status::failed, &error);
  EXPECT_EQ(summary.exit_status(), 3);
  EXPECT_EQ(summary.json()["error"]["what"], "no convergence");
}

TEST(Summary, WhatNobodyToldIsNull) {
  EXPECT_TRUE(empty().json()["device"].is_null());
  EXPECT_EQ(empty().number("device"), 0);
}

}  // namespace
}  // namespace tandem::launch
