// The particle solver, accessed through the protocol: checks before and during a run, and states on disk.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <thread>

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/scene/parse.hpp"
#include "dem_server/coupling/limit_watch.hpp"
#include "dem_server/coupling/make_solver.hpp"
#include "tests/support/error_of.hpp"

namespace tandem::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// Spheres of 1 cm given as lines of a file, above a floor.
struct Falling {
  std::string options;  // of dem, each ending in a comma
  std::string lines;    // of `columns`
  std::string gravity = "[0, 0, -9.81]";
  std::string coupling = R"({"window": 0.001})";
  std::string young = "1e7";
  std::string columns = "x,y,z,vx,vy,vz";

  protocol::Configuration configuration() const {
    protocol::Configuration c;
    c.scene_text = R"({"tandem": "1.0", "name": "falling", "end_time": 1, "gravity": )" + gravity +
                   R"(, "coupling": )" + coupling + R"(, "dem": {)" + options + R"(
        "materials": [{"name": "glass", "density": 2500, "young": )" +
                   young + R"(, "poisson": 0.25}],
        "pairs": [{"a": "glass", "b": "glass", "restitution": 0.6, "friction": 0.4}],
        "particles": [{"name": "fill", "material": "glass", "radius": 0.01, "fill": {"type": "file", "file": "fill.csv"}}],
        "walls": [{"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
        "domain": {"min": [-0.2, -0.2, -0.1], "max": [0.2, 0.2, 0.3]}}})";
    c.origin = "falling.json";
    c.files = {{"fill", columns + "\n" + lines}};
    c.backend = "cpu";
    c.threads = 1;
    return c;
  }
};

struct OneSolver {
  std::unique_ptr<protocol::LoadSolver> solver = dem::make_solver();
  json configured;
  Nanoseconds now;
  std::uint64_t windows = 0;

  explicit OneSolver(const Falling& scene) {
    log::setup("test", "error");
    configured = json::parse(solver->configure(scene.configuration()).facts);
  }
  const protocol::LoadSet& advance(int count) {
    protocol::MotionSet motion;
    const protocol::LoadSet* loads = nullptr;
    for (int i = 0; i < count; ++i) {
      motion.window = {windows++, now, now + Nanoseconds{1'000'000}};
      loads = &solver->advance(motion);
      now = motion.window.end;
    }
    return *loads;
  }
  json report() { return json::parse(solver->report().facts); }
  std::vector<std::string> warnings() { return report()["warnings"]; }
};

const std::string at_rest = "0,0,0.01,0,0,0\n0.05,0,0.01,0,0,0\n";

TEST(Solver, ObservesContactsWhereTheSceneAsksForThem) {
  const Falling two{.options = "", .lines = "0,0,0.00995,0,0,0\n0.1,0,0.1,0,0,0\n"};
  protocol::Configuration with = two.configuration();
  json scene = json::parse(with.scene_text);
  scene["output"]["fields"] = {"mean_stress"};
  with.scene_text = scene.dump();
  const auto solver = dem::make_solver();
  solver->configure(with);
  const std::vector<float> contacts = solver->observe().contacts;  // before the first window
  ASSERT_EQ(contacts.size(), 2 * protocol::ParticlesFrame::contact_values);
  EXPECT_EQ(contacts[0], 1);
  EXPECT_GT(contacts[1], 0);
  EXPECT_EQ(contacts[2], 0);
  EXPECT_EQ(contacts[3], 0);
  EXPECT_NE(solver->capabilities() & protocol::can_observe_contacts, 0u);
  OneSolver without(two);
  EXPECT_TRUE(without.solver->observe().contacts.empty());
}

TEST(Solver, ASnapshotIsTheFrameOfItsTimeAndIsReadWhileTheSolverAdvances) {
  OneSolver one({.options = "", .lines = "0,0,0.05,0,0,0\n0.1,0,0.1,0,0,0\n"});
  one.advance(1);
  const protocol::ParticlesFrame then = one.solver->observe();
  one.solver->snapshot();
  const protocol::ParticlesFrame* kept = nullptr;
  std::jthread reader([&] { kept = &one.solver->read_snapshot(); });
  one.advance(3);
  reader.join();
  EXPECT_EQ(kept->time, then.time);
  EXPECT_EQ(kept->id, then.id);
  EXPECT_EQ(kept->position, then.position);
  EXPECT_EQ(kept->velocity, then.velocity);
  EXPECT_EQ(kept->spin, then.spin);
  EXPECT_EQ(kept->radius, then.radius);
  EXPECT_NE(one.solver->observe().position, then.position);
}

TEST(MicroStep, AutoKeepsToTheShorterOfBothTimes) {
  OneSolver left_out({"", at_rest}), automatic({R"("micro_step": "auto",)", at_rest});
  const json &a = left_out.configured, &b = automatic.configured;
  EXPECT_EQ(a["micro_step_by"], "critical time");
  // A window has whole steps, none longer than that.
  const auto whole_steps = [](double longest) { return 1e-3 / std::ceil(1e-3 / longest); };
  EXPECT_NEAR(a["micro_step_s"].get<double>(), whole_steps(0.2 * a["critical_time_s"].get<double>()), 1e-15);
  EXPECT_EQ(b["micro_step_by"], "auto");
  EXPECT_NEAR(b["micro_step_s"].get<double>(), whole_steps(b["collision_time_s"].get<double>() / 20), 1e-15);
  EXPECT_LT(b["micro_step_s"].get<double>(), a["micro_step_s"].get<double>());
  // A fall by 0.11 m to the end of the domain: 1.469 m/s; Hertz's impact calculated by hand.
  const double m = 2500 * 4 / 3. * M_PI * 1e-6 / 2, k = 4 / 3. * 1e7 / (2 * 0.9375) * std::sqrt(0.005);
  const double expected = 2.94327 * std::pow(5 * m / (4 * k), 0.4) * std::pow(2 * 9.81 * 0.11, -0.1);
  std::printf("collision expected in %.6g s, measured %.6g s\n", expected,
              b["collision_time_s"].get<double>());
  EXPECT_NEAR(b["collision_time_s"].get<double>() / expected, 1, 1e-9);
  const auto steps = b["steps_per_window"].get<std::uint64_t>();
  EXPECT_EQ(automatic.advance(1).account.micro_steps, steps);
  EXPECT_EQ(steps, std::round(1e-3 / b["micro_step_s"].get<double>()));
}

TEST(MicroStep, FastCollisionsAreWarnedOfBeforeTheRunAndInIt) {
  OneSolver slow({"", at_rest});
  slow.advance(2);
  EXPECT_THAT(slow.warnings(), testing::IsEmpty());
  EXPECT_EQ(slow.report()["windows_of_too_long_steps"], 0);

  // Known at the start.
  OneSolver fast({"", "0,0,0.25,0,0,-150\n"});
  EXPECT_THAT(fast.warnings(),
              Contains(AllOf(HasSubstr("a collision at 150"), HasSubstr("use dem.micro_step = "))));
  EXPECT_EQ(fast.configured["warnings"], fast.report()["warnings"]) << "a run that fails has no report";
  fast.advance(1);
  EXPECT_THAT(fast.warnings(), Contains(HasSubstr("in 1 of 1 windows fewer than 6 micro steps")));

  // Only the check during the run includes head-on collisions of two spheres.
  OneSolver brisk({"", "-0.1,0,0.1,25,0,0\n"});
  EXPECT_THAT(brisk.warnings(), testing::IsEmpty());
  brisk.advance(2);
  EXPECT_THAT(brisk.warnings(), Contains(HasSubstr("in 2 of 2 windows fewer than 6 micro steps")));
  EXPECT_EQ(brisk.report()["windows_of_too_long_steps"], 2);
}

TEST(MicroStep, SoLongThatSpheresPassWallsUnseenIsWarnedOf) {
  Falling soft{"", "0,0,0.2,0,0,-200\n", "[0, 0, 0]"};
  soft.young = "1e5";
  OneSolver run(soft);
  EXPECT_THAT(
      run.warnings(),
      Contains(AllOf(HasSubstr("a sphere of 200 m/s"), HasSubstr("goes 0.2 m in a micro step of 0.001 s"),
                     HasSubstr("the smallest radius being 0.01 m: use dem.micro_step = 1.25e-05"))));
  run.advance(1);
  EXPECT_EQ(run.report()["windows_of_too_long_steps"], 1);
  EXPECT_THAT(run.warnings(), Contains(AllOf(HasSubstr("in 1 of 1 windows"),
                                             HasSubstr("so that they pass each other undetected"))));

  // The chosen step is short enough, also for two such spheres head on.
  soft.options = R"("micro_step": "auto",)";
  soft.lines = "0,0,0.2,0,0,-200\n0,0,0.05,0,0,200\n";
  OneSolver automatic(soft);
  EXPECT_LE(automatic.configured["micro_step_s"].get<double>(), 0.25 * 0.01 / 200);
  EXPECT_GT(automatic.advance(1).account.max_overlap_ratio, 0.1);
  EXPECT_THAT(automatic.warnings(), Not(Contains(HasSubstr("unseen"))));
}

TEST(MicroStep, WallsThatPassSpheresUnseenAreWarnedOf) {
  const scene::Scene scene = scene::parse(Falling{"", at_rest}.configuration().scene_text, "falling.json");
  particles::Spheres spheres;
  spheres.radius = {0.02, 0.01};
  spheres.material = {0, 0};
  spheres.position = spheres.velocity = spheres.spin = {{}, {}};
  spheres.id = {0, 1};
  dem::LimitWatch watch(*scene.dem, spheres);
  dem::LimitWatch::Record record;
  dem::WindowPlan plan;
  plan.dt = 1e-5;
  plan.body_speed = 490;
  EXPECT_THAT(watch.observe({}, plan, 0.1, record), testing::IsEmpty());
  // Collisions last long enough, but a wall moves 6 m in a step.
  plan.body_speed = 6e5;
  EXPECT_THAT(watch.observe({}, plan, 0.2, record),
              testing::ElementsAre(AllOf(HasSubstr("walls of up to 6e+05 m/s"), HasSubstr("nearer by 6 m"),
                                         HasSubstr("use dem.micro_step = 4.17e-09"))));
  EXPECT_THAT(watch.observe({}, plan, 0.3, record), testing::IsEmpty()) << "reported once";
  EXPECT_EQ(record.beyond_step, 2u);
  EXPECT_THAT(watch.warnings(record),
              testing::ElementsAre(AllOf(HasSubstr("in 2 of 3 windows"),
                                         HasSubstr("so that they pass each other undetected"))));
}

TEST(MicroStep, IsThatOfTheWindowAlsoInWarnings) {
  // The chosen step is longer than these windows, which shorten it enough.
  const std::string fast = "0,0,0.25,0,0,-150\n";
  OneSolver run({"", fast, "[0, 0, -9.81]", R"({"window": 1e-6})"});
  EXPECT_EQ(run.configured["steps_per_window"], 1);
  EXPECT_EQ(run.configured["micro_step_s"], 1e-6);
  EXPECT_THAT(run.warnings(), testing::IsEmpty());
}

TEST(MicroStep, SoManyThatNoneEndsAreRefused) {
  const auto refusal = [](const Falling& scene) { return error_of([&] { OneSolver{scene}; }); };
  EXPECT_EQ(refusal({R"("micro_step": 1e-8,)", at_rest}), "no error");
  EXPECT_EQ(refusal({R"("micro_step": 1e-12,)", at_rest}),
            "scene: dem.micro_step: the micro step of 1e-12 s cuts the window of 0.001 s into 1e+09 steps, "
            "more than 10000000 (enlarge it, or shorten coupling.window)");
  // 2^32 + 1 of them, which 32 bits would read as one; and a number too large for any type, which the parser
  // refuses.
  EXPECT_THAT(refusal({R"("micro_step": 2.3283064359965952e-13,)", at_rest}),
              HasSubstr("more than 10000000"));
  EXPECT_THAT(refusal({R"("micro_step": 1e-300,)", at_rest}), HasSubstr("give a number from 1e-18 to 1000"));
  // Chosen for the smallest sphere, or for the fastest collision.
  EXPECT_THAT(
      refusal({"", "0,0,0.1,0.01\n0.1,0,0.1,2e-10\n", "[0, 0, 0]", R"({"window": 0.001})", "1e7",
               "x,y,z,radius"}),
      AllOf(HasSubstr("chosen for a sphere of radius 2e-10 m of 'fill', cuts the window of 0.001 s into"),
            HasSubstr("(enlarge that radius, or leave the sphere out, or shorten coupling.window)")));
}

TEST(Memory, OfAWindowsStepsIsPredicted) {
  OneSolver run({R"("micro_step": 1e-8,)", at_rest});
  run.advance(1);
  const double predicted = run.configured["dem_memory_predicted_MB"], used = run.report()["dem_memory_MB"];
  std::printf("100000 steps: predicted %.4g MB, used %.4g MB\n", predicted, used);
  EXPECT_GT(used, 30);
  EXPECT_NEAR(predicted, used, 0.05 * used);
}

TEST(MicroStep, OfALongerWindowThanTheScenesAreRefused) {
  OneSolver run({R"("micro_step": 1e-8,)", at_rest});
  protocol::MotionSet motion;
  motion.window = {0, {}, {200'000'000}};
  EXPECT_THAT(error_of([&] { run.solver->advance(motion); }),
              AllOf(HasSubstr("protocol: motion"), HasSubstr("would have 2e+07 micro steps of 1e-08 s")));
}

TEST(Limits, WindowsBeyondThemAreCounted) {
  const std::string options = R"("overlap_limit": 0.001, "speed_limit": 1.5, "micro_step": 2e-5,)";
  OneSolver run({options, "0,0,0.0101,0,0,-2\n"});
  run.advance(30);
  const json facts = run.report();
  const auto deep = facts["windows_beyond_overlap_limit"].get<int>(),
             quick = facts["windows_beyond_speed_limit"].get<int>();
  std::printf("of 30 windows %d beyond the overlap limit, %d beyond the speed limit\n", deep, quick);
  EXPECT_GT(deep, 0);
  EXPECT_LT(deep, 30) << "the sphere leaves the floor again";
  EXPECT_GT(quick, 0);
  EXPECT_LT(quick, 30) << "it comes back slower";
  EXPECT_NEAR(facts["max_speed"].get<double>(), 2, 0.01);
  EXPECT_THAT(run.warnings(),
              Contains(HasSubstr(std::to_string(deep) + " of 30 windows had overlaps beyond")));
  EXPECT_THAT(run.warnings(),
              Contains(HasSubstr(std::to_string(quick) + " of 30 windows had spheres faster than")));
  EXPECT_THAT(run.warnings(), Contains(HasSubstr("use young = "))) << "warnings say what to use instead";

  OneSolver within({R"("overlap_limit": 0.9, "speed_limit": 3, "micro_step": 2e-5,)", "0,0,0.0101,0,0,-2\n"});
  within.advance(30);
  EXPECT_EQ(within.report()["windows_beyond_overlap_limit"], 0);
  EXPECT_EQ(within.report()["windows_beyond_speed_limit"], 0);
}

TEST(Limits, AWindowTakenBackIsNotCounted) {
  OneSolver run({R"("speed_limit": 1.5,)", "0,0,0.1,0,0,-2\n"});
  run.advance(1);
  run.solver->save();
  run.advance(3);
  run.solver->restore();
  EXPECT_EQ(run.report()["windows_beyond_speed_limit"], 1);
}

TEST(LostSpheres, AreCountedAndTold) {
  OneSolver run({"", "0,0,0.05,0,0,0\n0.199,0,0.05,1,0,0\n"});
  const protocol::LoadSet& loads = run.advance(5);
  EXPECT_EQ(loads.account.lost_particles, 1u);
  EXPECT_NEAR(loads.account.lost_momentum.x + loads.account.momentum_end.x, loads.account.momentum_begin.x,
              1e-12);
  EXPECT_THAT(run.warnings(), Contains(HasSubstr("1 spheres left the domain")));
}

TEST(StartSpeeds, ThatTheFirstStepWouldRefuseAreRefusedBefore) {
  const auto refusal = [](const Falling& scene) { return error_of([&] { OneSolver{scene}; }); };
  EXPECT_EQ(refusal({"", at_rest + "-0.1,0,0.1,0,0,200000\n"}),
            "scene: dem.particles[0] 'fill': sphere 2 at (-0.1, 0, 0.1) m starts with 200000 m/s; a run ends "
            "with a sphere of 100000 m/s (check its line in 'fill.csv', or the velocity of the group)");
  EXPECT_THAT(refusal({R"("precision": "double",)", "0,0,0.1,0,0,1e200\n"}),
              HasSubstr("starts with 1e+200 m/s"));
  EXPECT_EQ(refusal({"", "0,0,0.1,0,0,90000\n"}), "no error");
  // So soft that in one step such a sphere moves beyond the range of mixed precision.
  Falling soft{"", "0,0,0.1,0,0,90000\n"};
  soft.young = "1e3";
  EXPECT_THAT(refusal(soft), AllOf(HasSubstr("sphere 0 at (0, 0, 0.1) m starts with 90000 m/s"),
                                   HasSubstr("a shorter dem.micro_step, or \"precision\": \"double\"")));
  soft.options = R"("precision": "double",)";
  EXPECT_EQ(refusal(soft), "no error");
}

TEST(FailedSphere, IsToldOfWithItsHistory) {
  OneSolver run({"", "0.1,0,0.05,0,0,0\n0,0,0.00999,0,99990,0\n0.01992,0,0.01,0,0,0\n", "[0, 1e6, -9.81]"});
  run.solver->observe();
  const std::string message = error_of([&] { run.advance(3); });
  std::printf("%s\n", message.c_str());
  EXPECT_THAT(message,
              AllOf(HasSubstr("numerics: sphere 1, micro step 1"),
                    HasSubstr("a micro step before it was at (0, 0, 0.00999) m with (0, 99990, 0) m/s"),
                    HasSubstr("2 contacts: sphere 2 (0.008 of the smaller radius), wall 'floor' (0.001"),
                    HasSubstr("in the last frame, t = 0 s, it was at (0, 0, 0.00999)")));
}

TEST(StartOverlap, IsRefusedOrRelaxed) {
  const std::string lines = "0,0,0.05,0,0,0\n0.015,0,0.05,0,0,0\n";
  EXPECT_THAT(error_of([&] { OneSolver({"", lines}); }), HasSubstr("overlaps sphere 1"));
  OneSolver relaxed({R"("start_overlap": "relax",)", lines});
  EXPECT_EQ(relaxed.configured["start_relaxation"]["moved"], 2);
  EXPECT_THAT(relaxed.warnings(), Contains(HasSubstr("2 spheres were moved apart at the start")));
  EXPECT_LT(relaxed.advance(1).account.max_overlap_ratio, 0.011);
  OneSolver needless({R"("start_overlap": "relax",)", at_rest});
  EXPECT_EQ(needless.configured["start_relaxation"]["moved"], 0);
}

class Checkpoint : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  std::string refusal(const std::string& options, const std::string& lines, std::int64_t time = 20'000'000) {
    return error_of([&] { OneSolver({options, lines}).solver->resume({20, {time}, path_.string()}); });
  }
  const std::string lines_ =
      "0,0,0.02,0,0,-1\n0.012,0,0.04,0,0,-1\n-0.012,0.004,0.06,0,0,-1\n0.19,0,0.05,1,0,0\n";
  const std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("tandem_particles_" + std::to_string(getpid()) + ".h5");
};

TEST_F(Checkpoint, AnotherSolverGoesOnToTheSameBitsAndBooks) {
  const Falling scene{R"("speed_limit": 0.5,)", lines_};
  OneSolver straight(scene);
  straight.advance(20);
  straight.solver->checkpoint({20, straight.now, path_.string()});
  straight.advance(20);

  OneSolver resumed(scene);
  resumed.solver->resume({20, {20'000'000}, path_.string()});
  resumed.now = {20'000'000}, resumed.windows = 20;
  const protocol::LoadSet& loads = resumed.advance(20);
  EXPECT_EQ(loads.account.lost_particles, 1u);
  json a = straight.report(), b = resumed.report();
  for (const char* of_process : {"solver_seconds", "dem_solver_cpu_seconds", "sphere_steps"})
    a.erase(of_process), b.erase(of_process);
  EXPECT_EQ(a, b);
  EXPECT_GT(a["windows_beyond_speed_limit"], 20);
}

TEST_F(Checkpoint, StatesOfOtherScenesAreRefused) {
  OneSolver run({"", lines_});
  run.advance(20);
  run.solver->checkpoint({20, run.now, path_.string()});
  EXPECT_EQ(refusal("", lines_), "no error");
  EXPECT_THAT(refusal(R"("precision": "double",)", lines_),
              AllOf(HasSubstr("scene: "),
                    HasSubstr("is a state of variant hertz_mindlin, the scene has generic_double")));
  EXPECT_THAT(refusal(R"("contact": "hertz_frictionless",)", lines_), HasSubstr("variant hertz_mindlin"));
  EXPECT_THAT(refusal("", at_rest), HasSubstr("is a state of spheres: 4, the scene has 2"));
  EXPECT_THAT(refusal("", lines_, 21'000'000), HasSubstr("is the state at 0.02 s, not at 0.021 s"));
  std::filesystem::remove(path_);
  EXPECT_THAT(refusal("", lines_), AllOf(HasSubstr("resource: "), HasSubstr("does not exist")));
}

// Loads of a thousand bodies over a window of 9 million steps: terabytes, which must not be allocated.
TEST(Configure, ARunThatDoesNotFitIntoMemoryIsRefused) {
  protocol::Configuration c =
      Falling{R"("micro_step": 1e-7,)", at_rest, "[0, 0, 0]", R"({"window": 0.9})"}.configuration();
  json scene = json::parse(c.scene_text);
  for (int i = 0; i < 1000; ++i) {
    const std::string name = "b" + std::to_string(i);
    scene["mbd"]["bodies"].push_back(
        {{"name", name}, {"mass", 1}, {"inertia", {1, 1, 1}}, {"position", {0, 0, 0.2}}});
    scene["dem"]["walls"].push_back({{"name", name},
                                     {"body", name},
                                     {"material", "glass"},
                                     {"shape", {{"type", "sphere"}, {"radius", 0.01}}}});
  }
  c.scene_text = scene.dump();
  log::setup("test", "error");
  const std::string refusal = error_of([&] { dem::make_solver()->configure(c); });
  std::printf("  %s\n", refusal.c_str());
  EXPECT_THAT(refusal, AllOf(HasSubstr("resource"), HasSubstr("of host memory"),
                             HasSubstr("for the loads of a window's micro steps")));
}

TEST(Configure, TheLogSaysWhenTheGenericVariantRunsForWantOfAnother) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("tandem_configure_" + std::to_string(getpid()) + ".log");
  const auto log_of = [&](const std::string& options) {
    std::filesystem::remove(file);
    log::setup("test", "info", file);
    log::quiet();
    dem::make_solver()->configure(Falling{options, at_rest}.configuration());
    log::setup("test", "error");
    std::ifstream in(file);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const auto said =
      HasSubstr("no special variant for this law, precision, domain and outputs: the generic one runs");
  EXPECT_THAT(log_of(R"("precision": "double",)"), AllOf(said, HasSubstr("variant generic_double")));
  EXPECT_THAT(log_of(""), AllOf(Not(said), HasSubstr("variant hertz_mindlin")));
  EXPECT_THAT(log_of(R"("variant": "generic",)"), AllOf(Not(said), HasSubstr("variant generic")))
      << "it was asked for";
  EXPECT_THAT(log_of(R"("contact": "hertz_frictionless",)"), HasSubstr("left out: no friction: no spin"));
  std::filesystem::remove(file);
}

// A belt and the floor of the ground are one body in the loads, and a restart keeps the work of the drive.
TEST(Belt, BelongsToItsBodyAndContinuesFromAFile) {
  const auto scene_of = [](const std::string& lines) {
    Falling scene{"", lines};
    protocol::Configuration c = scene.configuration();
    json document = json::parse(c.scene_text);
    document["dem"]["walls"][0]["shape"]["point"] = {0, 0, -0.05};
    document["dem"]["walls"].push_back({{"name", "belt"},
                                        {"material", "glass"},
                                        {"position", {0, 0, -0.01}},
                                        {"shape", {{"type", "box"}, {"size", {0.2, 0.2, 0.02}}}},
                                        {"surface_velocity", {0.2, 0, 0}}});
    c.scene_text = document.dump();
    return c;
  };
  const protocol::Configuration configuration = scene_of("0,0,0.00999,0,0,0\n");
  const auto run = [&](protocol::LoadSolver& solver, std::uint64_t from, std::uint64_t to) {
    protocol::MotionSet motion;
    const protocol::LoadSet* loads = nullptr;
    for (std::uint64_t i = from; i < to; ++i) {
      motion.window = {
          i, {static_cast<std::int64_t>(i) * 1'000'000}, {static_cast<std::int64_t>(i + 1) * 1'000'000}};
      loads = &solver.advance(motion);
    }
    return *loads;
  };
  const auto straight = dem::make_solver(), resumed = dem::make_solver();
  straight->configure(configuration), resumed->configure(configuration);
  const std::string path = testing::TempDir() + "belt.dem";
  run(*straight, 0, 10);
  straight->checkpoint({10, {10'000'000}, path});
  resumed->resume({10, {10'000'000}, path});
  const protocol::LoadSet loads = run(*straight, 10, 20);
  run(*resumed, 10, 20);
  ASSERT_EQ(loads.bodies.size(), 1u);
  EXPECT_EQ(loads.bodies[0].body, ground.value);
  EXPECT_LT(loads.bodies[0].mean.force.z, 0);
  EXPECT_EQ(loads.bodies[0].work, 0) << "a belt does work on the spheres, none on the ground";
  const json a = json::parse(straight->report().facts), b = json::parse(resumed->report().facts);
  EXPECT_GT(a["belt_work_J"].get<double>(), 0);
  EXPECT_EQ(a["belts"]["belt"], b["belts"]["belt"]);
  EXPECT_EQ(a["dem_state_hash"], b["dem_state_hash"]);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tandem::test
