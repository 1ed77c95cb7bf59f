// Domains that follow a body.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "dem_server/coupling/state_hash.hpp"
#include "tests/support/particle_run.hpp"
#include "tests/support/solver_run.hpp"
#include "tests/support/tool_scene.hpp"

namespace tandem::test {
namespace {

using nlohmann::json;

// The solver, with a tool at this velocity.
struct ToolRun : SolverRun {
  Vec3d velocity{2, 0, 0};  // of the tool [m/s]

  explicit ToolRun(const json& scene, unsigned threads = 1) : SolverRun(scene, "tool.json", threads, "cpu") {}
  void advance(int count) {
    for (int i = 0; i < count; ++i) {
      const auto pose = [&](Nanoseconds t) {
        return Pose{Vec3d{0.4, 0.05, 0.2} + to_seconds(t) * velocity, exp({0, 0, 3 * to_seconds(t)})};
      };
      protocol::BodyMotion tool;
      tool.begin_pose = pose(now), tool.end_pose = pose(now + window);
      tool.begin_twist = tool.end_twist = {velocity, {0, 0, 3}};
      advance_window({tool});
    }
  }
};

class MovingDomain : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Variants, MovingDomain,
                         testing::Values("{}", R"({"contact": "hertz_frictionless"})",
                                         R"({"precision": "double"})",
                                         R"({"contact": "paper", "variant": "generic",
                                         "pairs": [{"a": "m", "b": "m", "friction": 0.4, "normal_stiffness": 7e5,
                                         "normal_damping": 20, "tangential_stiffness": 5e5, "tangential_damping": 5}]})"),
                         [](const auto& v) { return "case" + std::to_string(v.index); });

TEST_P(MovingDomain, LeavesBehindWhatIsOutsideAndBooksIt) {
  ToolRun run(tool_scene(json::parse(GetParam())));
  const std::size_t first = run.solver->observe().id.size();
  for (const int windows : {1, 49, 50}) {
    run.advance(windows);
    // Where it was at the begin of the last window.
    const double from = 2e-3 * static_cast<double>(run.windows - 1);
    const protocol::ParticlesFrame& f = run.solver->observe();
    double lowest = 1;
    for (std::size_t i = 0; i < f.id.size(); ++i) lowest = std::min(lowest, f.position[3 * i]);
    std::printf(
        "  from x = %.3f m on: %zu of %zu spheres, the first at %.4f m; momentum left open %.1e of %.2g N "
        "s\n",
        from, f.id.size(), first, lowest, norm(run.open), run.exchanged);
    EXPECT_GE(lowest, from);
    EXPECT_EQ(f.id.size() + run.lost, first);
    // 20 columns of 16 spheres that fall straight down.
    std::size_t expected = 0;
    for (int column = 0; column < 20; ++column) expected += 0.01 + 0.025 * column >= from ? 16 : 0;
    EXPECT_EQ(f.id.size(), expected);
  }
  EXPECT_GT(run.lost, 100u);
  EXPECT_LT(norm(run.open), 1e-12 * run.exchanged);
}

TEST_P(MovingDomain, GoesOnToTheSameBitsAfterEachWayBack) {
  const json scene = tool_scene(json::parse(GetParam()));
  ToolRun straight(scene);
  straight.advance(90);
  const std::string expected = straight.hash();
  ToolRun threaded(scene, 2);
  threaded.advance(90);
  EXPECT_EQ(threaded.hash(), expected);

  ToolRun back(scene);
  back.advance(60);
  back.solver->save();
  const Nanoseconds then = back.now;
  back.advance(20);
  back.solver->restore();
  back.now = then;
  back.advance(10);
  const std::string file =
      std::filesystem::temp_directory_path() / ("tool" + std::to_string(getpid()) + ".h5");
  back.solver->checkpoint({70, back.now, file});
  const Nanoseconds saved = back.now;
  back.advance(20);
  EXPECT_EQ(back.hash(), expected);
  EXPECT_EQ(back.lost, straight.lost);

  ToolRun resumed(scene);
  resumed.solver->resume({70, saved, file});
  resumed.now = saved;
  resumed.advance(20);
  EXPECT_EQ(resumed.hash(), expected);
  EXPECT_EQ(resumed.lost, straight.lost);
  std::filesystem::remove(file);
}

TEST(MovingDomains, InletsAndOutletsMoveWithIt) {
  json rain = {
      {"name", "rain"},
      {"material", "m"},
      {"radius", 0.01},
      {"fill", {{"type", "inlet"}, {"min", {0.4, 0, 0.2}}, {"max", {0.5, 0.1, 0.3}}, {"rate", 500}}}};
  json drain = {
      {{"name", "drain"}, {"region", {{"type", "plane"}, {"point", {0.1, 0, 0}}, {"normal", {-1, 0, 0}}}}}};
  const json wide = {{"min", {-0.2, -1, -0.01}}, {"max", {1.5, 1, 1}}, {"follows", "tool"}};
  json scene = tool_scene({{"particles", {rain}}, {"outlets", drain}, {"domain", wide}});
  scene["dem"]["walls"][0]["position"] = {0, 0, 0.5};  // away from the falling spheres
  ToolRun run(scene);
  run.velocity = {3, 0, 0};
  run.advance(500);  // by 1.5 m
  const protocol::ParticlesFrame& f = run.solver->observe();
  const double shift = 3e-3 * 499;
  ASSERT_GT(f.id.size(), 20u);
  for (std::size_t i = 0; i < f.id.size(); ++i) {
    EXPECT_GE(f.position[3 * i], shift + 0.1);
    EXPECT_LE(f.position[3 * i], shift + 0.5 + 3e-3);
  }
  EXPECT_GT(run.report()["went_out"], 100);
  EXPECT_EQ(run.lost, 0u) << "the outlet is before the domain's end";
  EXPECT_LT(norm(run.open), 1e-12 * run.exchanged);
}

// The cells move with the domain: a heap far from the start of the domain behaves like one in a domain that
// was always there. Both domains have the same extent, so that centres are counted in the same unit.
TEST(MovingDomains, SpheresMeetFarFromItsFirstPlace) {
  for (const char* precision : {"mixed", "double"}) {
    const auto scene_at = [&](double x) {
      json scene = tool_scene({{"precision", precision}});
      scene["dem"]["domain"] = {{"min", {x, 0, -0.01}}, {"max", {x + 0.5, 0.1, 0.3}}, {"follows", "tool"}};
      scene["dem"]["particles"][0]["fill"]["min"] = {x, 0, 0};
      scene["dem"]["particles"][0]["fill"]["max"] = {x + 0.5, 0.1, 0.1};
      return scene.dump();
    };
    const auto start = [](particles::Spheres& s) {
      for (std::size_t i = 0; i < s.size(); ++i) {
        s.position[i] = {7.55 + 0.021 * static_cast<double>(i % 18),
                         0.02 + 0.022 * static_cast<double>(i / 18 % 3),
                         0.011 + 0.0205 * static_cast<double>(i / 54)};
        s.velocity[i] = {0.3 * std::sin(static_cast<double>(i)), 0.2, -0.5};
      }
    };
    ParticleRun moved(scene_at(-8), particles::Backend::cpu, 1, start),
        always(scene_at(7.5), particles::Backend::cpu, 1, start);
    std::uint64_t rebuilds = 0, contacts = 0;
    for (int w = 0; w < 100; ++w) {
      std::vector<particles::PreparedPath> paths;
      for (int body = 0; body < 2; ++body) paths.push_back(particles::prepare_path({}, 1e-3));
      const dem::WindowOutcome& o = moved.engine->advance({50, 2e-5, paths, 0, 0, {15.5, 0, 0}});
      always.engine->advance({50, 2e-5, paths, 0, 0, {}});
      rebuilds = o.window.rebuilds;
      contacts += o.end.contacts;
    }
    EXPECT_GT(rebuilds, 5u);
    EXPECT_GT(contacts, 1000u);
    ASSERT_EQ(moved.state().size(), always.state().size());
    EXPECT_LT(largest_distance(moved.state(), always.state()), 1e-12);
  }
}

std::string refusal(const std::function<void()>& done) {
  try {
    done();
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

// Centres are 64-bit numbers with a finite range.
TEST(MovingDomains, TooFarForTheCountIsRefused) {
  const auto scene_at = [](double x, const char* precision) {
    json scene = tool_scene({{"precision", precision}});
    scene["dem"]["domain"] = {{"min", {x, 0, -0.01}}, {"max", {x + 0.5, 0.1, 0.3}}, {"follows", "tool"}};
    scene["dem"]["particles"][0]["fill"]["min"] = {x, 0, 0};
    scene["dem"]["particles"][0]["fill"]["max"] = {x + 0.5, 0.1, 0.1};
    return scene.dump();
  };
  const auto start = [&](double x, const char* precision) {
    return refusal([&] { ParticleRun run(scene_at(x, precision)); });
  };
  EXPECT_NE(start(1e7, "mixed").find("mixed precision counts to 65536 m"), std::string::npos)
      << start(1e7, "mixed");
  EXPECT_EQ(start(1e7, "double"), "none");
  EXPECT_EQ(start(1e4, "mixed"), "none");

  const auto follow = [&](double shift, const char* precision) {
    return refusal([&] {
      ParticleRun run(scene_at(0, precision));
      std::vector<particles::PreparedPath> paths(2, particles::prepare_path({}, 1e-3));
      run.engine->advance({50, 2e-5, paths, 0, 0, {shift, 0, 0}});
    });
  };
  EXPECT_NE(follow(1e4, "mixed")
                .find("the domain has followed its body to 10000 m, but for spheres of this size "
                      "mixed precision counts to 1024"),
            std::string::npos)
      << follow(1e4, "mixed");
  EXPECT_EQ(follow(1e4, "double"), "none");
  EXPECT_EQ(follow(400, "mixed"), "none");
}

}  // namespace
}  // namespace tandem::test
