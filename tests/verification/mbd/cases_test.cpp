// Ordinary machines and careless input, from the file to the answer: it is right, or the run says what is
// wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/scene/parse.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"

namespace tandem::mbd {
namespace {

constexpr double g = 9.81;

// A run of cases/NAME.json, window by window.
struct Case {
  scene::Scene scene;
  std::vector<protocol::BodiesFrame> frames;  // at the start, and at the end of each window
  std::vector<std::string> warnings;
  std::optional<Error> error;  // that ended it
  nlohmann::json report;       // facts at its end

  // `format`: of the scene, instead of that of the file.
  explicit Case(const std::string& name, const std::string& format = "") {
    log::setup("test", "error");
    const std::string file = std::string(TANDEM_MBD_CASES "/") + name + ".json";
    std::ifstream in(file);
    if (!in) throw std::runtime_error("there is no " + file);
    std::ostringstream text;
    text << in.rdbuf();
    MbdSolver solver;
    try {
      auto json = nlohmann::json::parse(text.str());
      if (!format.empty()) json["tandem"] = format;
      scene = scene::parse(json.dump(), file);
      scene::validate(scene, file);
      warnings = scene::warnings(scene);
      note(solver.configure(scene).facts);
      frames.push_back(solver.observe());
      const double window = scene.coupling.window;
      const auto count = static_cast<std::uint64_t>(std::llround(scene.end_time / window));
      protocol::LoadSet loads;
      for (std::uint64_t n = 0; n < count; ++n) {
        loads.window = {n, to_nanoseconds(static_cast<double>(n) * window),
                        to_nanoseconds(static_cast<double>(n + 1) * window)};
        solver.advance(loads);
        frames.push_back(solver.observe());
      }
      const std::string facts = solver.report().facts;
      note(facts);
      report = nlohmann::json::parse(facts);
    } catch (const Error& e) {
      error = e;
    }
  }

  // Ran to its end, without a word.
  void expect_quiet() const {
    EXPECT_FALSE(error) << error->what();
    EXPECT_TRUE(warnings.empty()) << warnings.front();
  }
  // Refused, or done with a warning, that has all of these words in it.
  bool says(const std::vector<std::string>& words) const {
    std::vector<std::string> texts = warnings;
    if (error) texts.push_back(error->what());
    return std::any_of(texts.begin(), texts.end(), [&](const std::string& text) {
      return std::all_of(words.begin(), words.end(),
                         [&](const std::string& word) { return text.find(word) != std::string::npos; });
    });
  }
  std::string said() const {
    std::string all = error ? error->what() : "";
    for (const std::string& warning : warnings) all += "\n" + warning;
    return all.empty() ? "nothing was said" : all;
  }
  const protocol::JointState& joint(const std::string& name, const protocol::BodiesFrame& frame) const {
    const auto& joints = scene.mbd->joints;
    for (std::size_t j = 0; j < joints.size(); ++j)
      if (joints[j].name == name) return frame.joints.at(j);
    throw std::runtime_error("there is no joint " + name);
  }
  const protocol::JointState& joint(const std::string& name) const { return joint(name, frames.back()); }
  const protocol::BodyState& body() const { return frames.back().bodies.at(0); }

 private:
  void note(const std::string& text) {
    const auto facts = nlohmann::json::parse(text);
    if (!facts.contains("warnings")) return;
    for (const auto& warning : facts["warnings"])
      warnings.push_back(warning.is_string() ? warning.get<std::string>() : warning.dump());
  }
};

// Largest value over all frames; 0 without frames.
template <class Function>
double worst(const Case& run, const Function& value) {
  double largest = 0;
  for (const auto& frame : run.frames) {
    const double now = value(frame);
    if (!std::isnan(largest) && !(now <= largest)) largest = now;
  }
  return largest;
}

// A shaft of 0.02 kg m2 under 0.3 N m, 2 s from rest: 30 rad/s. Its bearings carry 3 kg.
void expect_shaft_turns(const std::string& name) {
  const Case run(name);
  run.expect_quiet();
  ASSERT_FALSE(run.frames.empty());
  const auto sum = [](const protocol::BodiesFrame& frame) {
    Vec3d force;
    for (const auto& joint : frame.joints) force += joint.reaction.force;
    return norm(force - Vec3d{0, 0, 3 * g});
  };
  const auto largest = [](const protocol::BodiesFrame& frame) {
    double force = 0;
    for (const auto& joint : frame.joints) force = std::max(force, norm(joint.reaction.force));
    return force;
  };
  EXPECT_NEAR(run.joint("b1").rate, 30, 1e-6);
  EXPECT_LT(worst(run, sum), 1e-6);
  EXPECT_LT(worst(run, largest), 60);
}

TEST(Case, ShaftWithABearingAtTheOriginTurns) {
  expect_shaft_turns("shaft_bearing_at_origin");
}

// A tree with ball joint, spring and motors whose step is too long, and a vibration of 5 mm in a machine of 1
// m with 22 steps in a period: off by 14 % of the size, and by more than its amplitude. Trees with springs in
// which small errors grow: off by 15 and by 2 % of the size.
TEST(Case, ErrorsOfTheStepAreStated) {
  for (const auto& [name, least] :
       {std::pair{"tree_local_errors", .05}, std::pair{"small_vibration", .05},
        std::pair{"tree_springs_universal", .05}, std::pair{"tree_springs_spherical", .01}}) {
    const Case run(name);
    ASSERT_FALSE(run.error) << run.error->what();
    const auto& estimate = run.report["mbd_position_error_estimate"];
    const double says =
        estimate.is_number() ? estimate.get<double>() : run.report["mbd_local_error_sum"].get<double>();
    std::printf("%s: stated error %.3g, expected above %g\n", name, says, least);
    EXPECT_GT(says, least);
  }
}

TEST(Case, ShaftInACoordinatePlaneTurns) {
  expect_shaft_turns("shaft_in_a_coordinate_plane");
}

// Where the input of a Cardan joint at 30 degrees has turned by `angle` out of the plane of the shafts the
// output turns faster by this, Hooke's ratio.
double hooke(double angle) {
  const double c = std::sqrt(.75);
  return c / (std::pow(std::cos(angle), 2) + c * c * std::pow(std::sin(angle), 2));
}

TEST(Case, CardanShaftAtTheOriginKeepsItsEnergy) {
  const Case run("cardan_at_origin_free");
  run.expect_quiet();
  ASSERT_FALSE(run.frames.empty());
  const double energy = .5 * .1 * 100 * (1 + .75);
  EXPECT_LT(worst(run, [&](const auto& frame) { return std::abs(frame.energy - energy); }), 1e-3 * energy);
  EXPECT_LT(worst(run,
                  [&](const auto& frame) {
                    const auto& in = run.joint("A", frame);
                    return std::abs(norm(frame.bodies[1].twist.w_WB) - hooke(in.q) * in.rate);
                  }),
            1e-6);
  EXPECT_GT(run.joint("A").rate, 5);
}

TEST(Case, DrivenCardanShaftAtTheOriginRuns) {
  const Case run("cardan_at_origin_driven");
  run.expect_quiet();
  ASSERT_FALSE(run.frames.empty());
  EXPECT_LT(
      worst(run,
            [&](const auto& frame) {
              return std::abs(norm(frame.bodies[1].twist.w_WB) - 10 * hooke(10 * to_seconds(frame.time)));
            }),
      1e-6);
}

// Two hinges of seven digits: the motion of one hinge.
TEST(Case, DoorOfSevenDigitsSwings) {
  const Case run("door_seven_digits");
  run.expect_quiet();
  ASSERT_FALSE(run.frames.empty());
  EXPECT_NEAR(run.joint("lower").q, -5.3386, 1e-3);
}

// theta'' = -c g cos theta from pi/2 at -1 rad/s, c = [(N + 1)/2 + N] / [(N + 1)/3 + N] for N = 2 windows.
TEST(Case, FourBarWithATiltedHingeTurns) {
  const Case run("four_bar_hinge_tilted_1e-9");
  run.expect_quiet();
  ASSERT_FALSE(run.frames.empty());
  const double c = (1.5 + 2) / (1 + 2), h = 1e-4;
  double angle = std::acos(0.0), rate = -1;
  for (int i = 0; i < 20000; ++i) {  // symplectic, of second order
    rate -= h / 2 * c * g * std::cos(angle);
    angle += h * rate;
    rate -= h / 2 * c * g * std::cos(angle);
  }
  EXPECT_NEAR(run.joint("a0").q, angle - std::acos(0.0), 2e-3);
}

// A pendulum of 1 m on a spring of 1e12 N/m that is stretched by 1e-6 m, whose vibration has 160 periods in a
// step: its length is right, its vibration is not resolved, and that is said with a step to use.
TEST(Case, StiffSpringSwingsByItsElongation) {
  const Case run("spring_wrong_root");
  ASSERT_FALSE(run.error) << run.error->what();
  double angle = 0, rate = 0, off_length = 0, off_path = 0, gained = 0;
  constexpr double h = 1e-4;
  for (std::size_t n = 1; n < run.frames.size(); ++n) {
    for (int i = 0; i < 100; ++i) {
      rate -= h / 2 * g * std::cos(angle);
      angle += h * rate;
      rate -= h / 2 * g * std::cos(angle);
    }
    const Vec3d p = run.frames[n].bodies[0].pose.p_WB;
    off_length = std::max(off_length, std::abs(norm(p) - 1));
    off_path = std::max(off_path, norm(p - Vec3d{std::cos(angle), std::sin(angle), 0}));
    gained = std::max(gained, run.frames[n].energy - run.frames[0].energy);
  }
  EXPECT_LT(off_length, 3e-6);
  EXPECT_LT(off_path, 1e-2);
  EXPECT_LT(gained, 50);
  EXPECT_TRUE(run.says({"steps of the multibody part were taken in parts", "mbd.integrator.step"}));
}

// 5e9 J in a spring of which a step sees nothing: the mass is thrown through the anchor and back within a
// window.
TEST(Case, StiffSpringThatThrowsItsMassAwayLeavesItsMarkInTheEnergyBalance) {
  const Case run("stiff_spring_through_its_anchor");
  ASSERT_FALSE(run.error) << run.error->what();
  EXPECT_GT(std::abs(run.report.at("mbd_largest_energy_balance_J").get<double>()),
            0.1 * run.report.at("mbd_energy_scale_J").get<double>());
}

// Parallelogram with three cranks, which lie flat on the rod twice per turn. Either they keep parallel, or
// the report has the turn of one that did not.
TEST(Case, ThreeCranksThatLieFlatKeepParallelOrAreMarked) {
  const Case run("three_cranks_nine_digits");
  ASSERT_FALSE(run.error) << run.error->what();
  const auto apart = [](const protocol::BodiesFrame& frame) {
    const Vec3d way = frame.bodies[1].pose.p_WB - frame.bodies[0].pose.p_WB;
    return norm(frame.bodies[2].pose.p_WB - frame.bodies[1].pose.p_WB - way);
  };
  if (worst(run, apart) > 1e-4) {
    EXPECT_GT(run.report.at("mbd_sharpest_turn").get<double>(), 20);
  }
}

// The cranks of exact data keep parallel, and no turn is reported.
TEST(Case, ExactParallelogramThatLiesFlatIsNotMarked) {
  const Case run("four_bar_hinge_tilted_1e-9");
  ASSERT_FALSE(run.error) << run.error->what();
  EXPECT_LT(run.report.at("mbd_sharpest_turn").get<double>(), 20);
}

// Falls by 0.1 m onto a stop without damping. Frames are 10 ms apart: the highest one may miss the top by
// 0.12 mm.
void expect_rebound(const std::string& name, bool closed_form) {
  const Case run(name);
  EXPECT_FALSE(run.error) << run.error->what();
  ASSERT_FALSE(run.frames.empty());
  double after = -1, lowest = 0, highest_since = -1, off_top = 0;
  int rebounds = 0;
  bool rising = false;
  for (std::size_t n = 1; n < run.frames.size(); ++n) {
    const double y = run.frames[n].bodies[0].pose.p_WB.y, last = run.frames[n - 1].bodies[0].pose.p_WB.y;
    lowest = std::min(lowest, y);
    if (to_seconds(run.frames[n].time) > .143) after = std::max(after, y);
    if (y > last) rising = true, highest_since = std::max(highest_since, y);
    if (y < last && rising) {
      ++rebounds;
      off_top = std::max(off_top, std::abs(highest_since));
      rising = false, highest_since = -1;
    }
  }
  EXPECT_LE(after, 1e-9) << "higher than it fell";
  EXPECT_GT(lowest, -.1 - 2e-3) << "through the stop";
  if (!closed_form) return;
  EXPECT_GE(rebounds, 9);
  EXPECT_LT(off_top, 1e-3);
}

TEST(Case, StopOf1e7AtAFixedStepReturnsNoMoreThanItGot) {
  expect_rebound("stop_1e7_fixed_step", false);
}

TEST(Case, StopOf1e9UnderErrorControlReturnsWhatItGot) {
  expect_rebound("stop_1e9_error_control", true);
}

TEST(Case, StopOf1e12UnderErrorControlReturnsWhatItGot) {
  expect_rebound("stop_1e12_error_control", true);
}

// No force before 0.5 s, 100 N on 1 kg after 0.501 s.
TEST(Case, ForceTableWithAStepDoesNotSwing) {
  const Case old("force_table_step");
  EXPECT_TRUE(old.says({"'a'", "overshoots", "monotone"})) << old.said();
  const Case run("force_table_step", "1.1");
  run.expect_quiet();
  ASSERT_FALSE(run.error) << run.error->what();
  const auto before = [&](const auto& frame) {
    return frame.time <= to_nanoseconds(.5) ? std::abs(run.joint("j", frame).rate) : 0;
  };
  EXPECT_LT(worst(run, before), 1e-9);
  EXPECT_NEAR(run.joint("j").rate, 49.95, 1e-3);
}

TEST(Case, MotionTableWithAStepStaysBetweenItsValues) {
  const Case old("motion_table_10_ms");
  EXPECT_TRUE(old.says({"'j'", "overshoots", "monotone"})) << old.said();
  const Case run("motion_table_10_ms", "1.1");
  run.expect_quiet();
  ASSERT_FALSE(run.error) << run.error->what();
  EXPECT_LT(worst(run, [&](const auto& frame) { return std::abs(run.joint("j", frame).q - .5) - .5; }),
            1e-12);
  EXPECT_NEAR(run.joint("j").q, 1, 1e-12);
}

// The drive stands still from 0.5 s on, which is said. About the hinge, which stops, the second body keeps
// its angular momentum: (0.1 + 1) w = 0.1 * 1 + 1 * 2. In format 1.1 the drive comes to rest.
TEST(Case, MotionThatEndsAtSpeedIsSaid) {
  const Case run("motion_ends_at_speed");
  EXPECT_TRUE(run.says({"\"j\"", "motion"}) || run.says({"'j'", "motion"}) ||
              run.says({"joints[0]", "motion"}))
      << run.said();
  EXPECT_NEAR(run.joint("k").rate, 2.1 / 1.1, 1e-9);
  Case("motion_ends_at_speed", "1.1").expect_quiet();
}

// 2 m/s at 1 m from the hinge is 2 rad/s, but the body is given none.
TEST(Case, VelocityOfABodyOnACutJointIsKeptOrRefused) {
  const Case run("velocity_of_cut_body_changed");
  if (run.error || run.says({"velocity", "\"b\""})) return;
  EXPECT_LT(worst(run, [](const auto& frame) { return std::abs(norm(frame.bodies[0].twist.v_WB) - 2); }),
            1e-6)
      << run.said();
}

TEST(Case, MotionThroughItsOwnStopIsSaid) {
  const Case run("motion_through_stop");
  EXPECT_TRUE(run.says({"motion", "limit"}) || run.says({"motion", "stop"})) << run.said();
}

}  // namespace
}  // namespace tandem::mbd
