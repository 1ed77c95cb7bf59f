// Joints that do not fit together by more than digits can explain: locked as drawn. Such a scene is refused,
// and the error names a joint or a coupler of the loop.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "common/error.hpp"
#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/constrained_machines.hpp"
#include "tests/verification/mbd/recorded_run.hpp"

namespace tandem::mbd {
namespace {

scene::Scene machine(const std::string& name) {
  for (const ConstrainedMachine& m : constrained_machines())
    if (m.name == name) return m.scene;
  throw std::runtime_error("there is no machine " + name);
}

scene::Joint& joint(scene::Scene& scene, const std::string& name) {
  const auto found = std::find_if(scene.mbd->joints.begin(), scene.mbd->joints.end(),
                                  [&](const scene::Joint& j) { return j.name == name; });
  if (found == scene.mbd->joints.end()) throw std::runtime_error("there is no joint " + name);
  return *found;
}

// As drawn and in other frames.
void expect_refused(const scene::Scene& scene, const std::vector<std::string>& names) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 20; ++i) {
    const test::RigidMotion motion(i == 0 ? Quat{} : test::random_rotation(random), {},
                                   i % 2 ? Vec3d{.3, -1, .7} : Vec3d{});
    try {
      const RecordedRun run = record(test::moved(scene, motion), .4, 4);
      ADD_FAILURE() << "frame " << i << " ran with " << run.degrees_of_freedom << " degrees of freedom, "
                    << run.redundant << " redundant equations and " << run.warnings.size() << " warnings";
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_EQ(error.code(), ErrorCode::scene) << text;
      EXPECT_TRUE(std::any_of(names.begin(), names.end(), [&](const std::string& name) {
        return text.find("\"" + name + "\"") != std::string::npos;
      })) << text;
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(ContradictoryData, SecondHingeOfADoorTilted) {
  scene::Scene scene = machine("door_on_two_hinges");
  joint(scene, "h1").axis = normalized(Vec3d{.01, 0, 1});
  expect_refused(scene, {"h0", "h1"});
}

TEST(ContradictoryData, SecondHingeOfADoorBesideTheLineOfTheFirst) {
  scene::Scene scene = machine("door_on_two_hinges");
  joint(scene, "h1").position += Vec3d{.008, 0, 0};
  expect_refused(scene, {"h0", "h1"});
}

TEST(ContradictoryData, BearingOfAShaftBesideTheLineOfTheOthers) {
  scene::Scene scene = machine("shaft_on_three_bearings");
  joint(scene, "b1").position += Vec3d{.001, .002, 0};
  expect_refused(scene, {"b0", "b1", "b2"});
}

TEST(ContradictoryData, GuidesThatAreNotParallel) {
  scene::Scene scene = machine("two_prismatic_guides");
  joint(scene, "g1").axis = normalized(Vec3d{1, .01, 0});
  expect_refused(scene, {"g0", "g1"});
}

TEST(ContradictoryData, HingeOfAFourBarTiltedOutOfItsPlane) {
  scene::Scene scene = machine("four_bar");
  joint(scene, "B").axis = normalized(Vec3d{.01, 0, 1});
  expect_refused(scene, {"O", "A", "B", "C"});
}

TEST(ContradictoryData, MiddleCrankOfAParallelogramTooShort) {
  scene::Scene scene = machine("parallelogram");
  joint(scene, "top1").position += Vec3d{-.003, .004, 0};
  expect_refused(scene, {"foot0", "foot1", "foot2", "top0", "top1", "top2"});
}

TEST(ContradictoryData, BarOfAParallelogramTooShort) {
  scene::Scene scene = machine("parallelogram");
  scene::Joint& top = joint(scene, "top2");
  top.child_position = top.position - Vec3d{.009, 0, 0};
  expect_refused(scene, {"foot0", "foot1", "foot2", "top0", "top1", "top2", "crank2", "bar"});
}

TEST(ContradictoryData, GearsThatAskForTwoRatios) {
  scene::Scene scene = machine("gear_ring");
  scene.mbd->couplers.back().ratio *= 1.01;
  expect_refused(scene, {"g01", "g12", "g02"});
}

TEST(ContradictoryData, HingeOfABennettLinkageTurned) {
  scene::Scene scene = machine("bennett");
  joint(scene, "h2").axis = normalized(joint(scene, "h2").axis + Vec3d{.01, .01, 0});
  expect_refused(scene, {"h0", "h1", "h2", "h3"});
}

TEST(ContradictoryData, BarLongerThanTheDistanceOfItsBalls) {
  scene::Scene scene = machine("bar_on_two_balls");
  scene::Joint& end = joint(scene, "b");
  end.child_position = end.position + Vec3d{.008, 0, 0};
  expect_refused(scene, {"a", "b", "bar"});
}

}  // namespace
}  // namespace tandem::mbd
