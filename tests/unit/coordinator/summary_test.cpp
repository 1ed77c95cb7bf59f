#include "coordinator/run/summary.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/support/page_table.hpp"

namespace tandem::launch {
namespace {

using protocol::Role;

Summary empty() {
  static const SceneFile file = [] {
    SceneFile toy;
    toy.origin = "toy.json";
    toy.scene.name = "toy";
    return toy;
  }();
  return Summary(file, {});
}

TEST(Summary, JoinsTheListsOfBothSolvers) {
  Summary summary = empty();
  summary.add_facts(Role::mbd, R"({"left_out": ["no springs"], "warnings": []})");
  summary.add_facts(Role::dem,
                    R"({"left_out": ["no friction", "no springs"], "warnings": ["fast"], "spheres": 7})");
  EXPECT_EQ(summary.json()["left_out"].dump(), R"(["no springs","no friction"])");
  EXPECT_EQ(summary.json()["warnings"].dump(), R"(["fast"])");
  EXPECT_EQ(summary.facts().dem.spheres, 7u);
  EXPECT_EQ(summary.json()["spheres"], 7);
}

TEST(Summary, KeepsTheSecondsOfTheSolversApart) {
  Summary summary = empty();
  summary.add_facts(Role::mbd, R"({"solver_seconds": 1.5})");
  summary.add_facts(Role::dem, R"({"solver_seconds": 2.5})");
  EXPECT_EQ(summary.json()["mbd_solver_seconds"], 1.5);
  EXPECT_EQ(summary.json()["dem_solver_seconds"], 2.5);
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

TEST(Summary, AFactReplacesNoKeyOfTheCoordinator) {
  for (const char* key : {"status", "scene", "mbd_server", "time_split", "checks", "momentum_balance",
                          "lost_particles", "state_hash", "windows_of_too_large_error"}) {
    Summary summary = empty();
    try {
      summary.add_facts(Role::dem, fmt::format(R"({{"{}": 1}})", key));
      ADD_FAILURE() << key << " was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::protocol);
      EXPECT_EQ(error.where(), "dem_server");
    }
  }
}

TEST(Summary, ThePageHasTheKeysOfTheCoordinator) {
  tandem::test::expect_on_page("docs/results.md", "coordinator keys", coordinator_keys_as_markdown());
}

TEST(Summary, AProgramThatCallsItselfAsOursIsToldByItsCommand) {
  SceneFile file;
  file.scene.dem.emplace();
  Summary summary(file, {});
  protocol::Hello hello;
  hello.program = "dem_server 0.1.0";
  summary.set_server(Role::dem, hello, ServerCommand{"./mine --fast", "/opt/mine", {"--fast"}});
  EXPECT_EQ(summary.not_reported(Role::dem), "not reported by dem_server 0.1.0 ('./mine --fast')");
  summary.set_server(Role::dem, hello, {});
  EXPECT_EQ(summary.not_reported(Role::dem), "not reported by dem_server 0.1.0");
}

TEST(Summary, AForeignSolverThatReportsNothingIsSaidToReportNothing) {
  static const SceneFile file = [] {
    SceneFile scene;
    scene.scene.name = "swap";
    scene.scene.dem.emplace();
    return scene;
  }();
  Summary summary(file, {});
  protocol::Hello hello;
  hello.program = "liggghts 3.8";
  summary.set_server(Role::dem, hello, ServerCommand{"lmp --fast", "/opt/lmp", {"--fast"}});
  summary.add_facts(Role::dem, "{}");
  EXPECT_EQ(summary.json()["dem_server"].dump(), R"({"program":"liggghts 3.8","command":"lmp --fast"})");
  EXPECT_TRUE(summary.json()["mbd_server"].is_null());
  EXPECT_TRUE(summary.json()["spheres"].is_null()) << "0 would be a number of spheres";
  const std::string table = summary.table();
  EXPECT_NE(table.find("liggghts 3.8, started by lmp --fast"), std::string::npos) << table;
  EXPECT_NE(table.find("not reported by liggghts 3.8"), std::string::npos) << table;
  summary.add_facts(Role::dem, R"({"backend": "gpu"})");
  EXPECT_NE(summary.table().find("number of spheres unknown on gpu\n"), std::string::npos);
}

TEST(Summary, BytesThatAreNotUtf8AreShownAndDoNotStopTheWriting) {
  Summary summary = empty();
  try {
    summary.add_facts(Role::dem, "{\"device\": \"\xff\"}");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::protocol);
    EXPECT_NE(error.problem().find("\\xff"), std::string::npos) << error.what();
    summary.fail(error);
  }
  summary.add_warning("caf\xe9");
  summary.fail(Error(ErrorCode::peer_lost, "said \xff", "\xfe", "\xfd"));
  EXPECT_EQ(summary.json()["warnings"].dump(), "[\"caf\\\\xe9\"]");
  EXPECT_EQ(summary.json()["error"]["what"], "said \\xff");
  const auto file = std::filesystem::temp_directory_path() / fmt::format("tandem_utf8_{}.json", getpid());
  summary.write(file);
  EXPECT_GT(std::filesystem::file_size(file), 100u);
  std::filesystem::remove(file);
}

TEST(Summary, IsRunningUntilItEnds) {
  const Summary summary = empty();
  EXPECT_EQ(summary.json()["status"], "running");
  EXPECT_EQ(status_now(nlohmann::json(summary.json())), "running");
}

TEST(Summary, HowItEndedDecidesStatusReasonAndExitStatus) {
  const auto ending = [](const auto& end) {
    Summary summary = empty();
    end(summary);
    const auto& json = summary.json();
    EXPECT_EQ(json["exit_status"], summary.exit_status());
    EXPECT_EQ(json["status"], name(summary.status()));
    return fmt::format("{} {} {}", json["status"].get<std::string>(), json.value("reason", "-"),
                       summary.exit_status());
  };
  const auto suspect = [](Summary& summary) {
    summary.add_facts(Role::mbd, R"({"mbd_largest_constraint_violation": 0.1})");
  };
  EXPECT_EQ(ending([](Summary& s) { s.complete(true, true); }), "ok - 0");
  EXPECT_EQ(ending([](Summary& s) { s.complete(false, false); }), "failed checks 1");
  EXPECT_EQ(ending([&](Summary& s) { suspect(s), s.complete(true, false); }), "suspect - 0");
  EXPECT_EQ(ending([&](Summary& s) { suspect(s), s.complete(true, true); }), "suspect - 1");
  EXPECT_EQ(ending([&](Summary& s) { suspect(s), s.complete(false, false); }), "failed checks 1");
  EXPECT_EQ(ending([](Summary& s) { s.interrupt(); }), "failed interrupted 130");
  EXPECT_EQ(ending([](Summary& s) {
              s.fail(Error(ErrorCode::numerics, "no convergence", "mbd_server", "a shorter step"));
              EXPECT_EQ(s.json()["error"]["what"], "no convergence");
            }),
            "failed numerics 3");
}

TEST(Summary, TheTableShowsWhatIsSuspect) {
  Summary summary = empty();
  summary.add_facts(Role::mbd, R"({"mbd_largest_constraint_violation": 0.1})");
  summary.complete(true, false);
  EXPECT_TRUE(summary.table().starts_with("toy: SUSPECT\n  SUSPECT "));
  EXPECT_EQ(summary.json()["verdict"]["lines"].size(), 1u);
}

// A concurrent reader finds a complete file at any time.
TEST(Summary, IsReplacedAsAWhole) {
  const auto folder = std::filesystem::temp_directory_path() / ("tandem_summary_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto file = folder / "summary.json";
  Summary summary = empty();
  summary.write(file);
  std::ifstream before(file);
  summary.complete(true, false);
  summary.write(file);
  EXPECT_EQ(nlohmann::json::parse(before)["status"], "running");
  EXPECT_EQ(nlohmann::json::parse(std::ifstream(file))["status"], "ok");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()),
            1);
  std::filesystem::remove_all(folder);
}

TEST(Summary, WhatNobodyToldIsNull) {
  EXPECT_TRUE(empty().json()["device"].is_null());
  EXPECT_FALSE(empty().facts().dem.device);
}

}  // namespace
}  // namespace tandem::launch
