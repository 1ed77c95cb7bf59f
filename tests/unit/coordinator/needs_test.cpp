#include "coordinator/start/needs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/scene/scene_file.hpp"

namespace tandem::launch {
namespace {

using namespace protocol;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t every_capability = can_predict | can_rollback | can_interpolate | can_window_mean |
                                           can_linearise | can_extrapolate | can_control | can_checkpoint |
                                           can_observe_elements | can_observe_contacts | can_observe_walls;
// What a particle solver that only steps forward has.
constexpr std::uint64_t forward = can_interpolate | can_window_mean;

scene::Scene box() {
  return read_scene(std::string(TANDEM_SOURCE_DIR) + "/tests/system/scenes/hanging_box.json").scene;
}

scene::Scene with(scene::Scheme scheme) {
  scene::Scene scene = box();
  scene.coupling.scheme = scheme;
  return scene;
}

TEST(Needs, AreOnlyWhatTheSchemeUses) {
  using scene::Scheme;
  EXPECT_EQ(needed_of(protocol::Role::mbd, with(Scheme::mbd_first)), 0u) << "it predicts nothing";
  for (const Scheme scheme : {Scheme::parallel, Scheme::dem_first})
    EXPECT_EQ(needed_of(protocol::Role::mbd, with(scheme)), std::uint64_t{can_predict});
  for (const Scheme scheme : {Scheme::parallel, Scheme::mbd_first, Scheme::dem_first})
    EXPECT_EQ(needed_of(protocol::Role::dem, with(scheme)), forward);
  EXPECT_EQ(needed_of(protocol::Role::mbd, with(Scheme::implicit)),
            std::uint64_t{can_predict | can_rollback});
  EXPECT_EQ(needed_of(protocol::Role::dem, with(Scheme::implicit)), forward | can_rollback);
  EXPECT_EQ(needed_of(protocol::Role::mbd, with(Scheme::linear_implicit)),
            std::uint64_t{can_predict | can_rollback});
  EXPECT_EQ(needed_of(protocol::Role::dem, with(Scheme::linear_implicit)), forward | can_linearise)
      << "only the bodies repeat";
}

TEST(Needs, AreThoseOfTheOtherSettings) {
  scene::Scene scene = box();
  scene.coupling.load = scene::LoadShape::linear;
  scene.coupling.path = scene::PathShape::quadratic;
  EXPECT_EQ(needed_of(protocol::Role::mbd, scene), std::uint64_t{can_extrapolate})
      << "it predicts by extrapolate";
  scene.coupling.adaptive.emplace();
  EXPECT_EQ(needed_of(protocol::Role::mbd, scene), std::uint64_t{can_extrapolate | can_rollback});
  EXPECT_EQ(needed_of(protocol::Role::dem, scene), forward | can_rollback);
  scene.mbd->forces.push_back(scene::Actuator{"motor", JointId{0}, scene::ConstantMotion{}, "drive"});
  EXPECT_TRUE(needed_of(protocol::Role::mbd, scene) & can_control);
  scene.dem.reset();
  EXPECT_EQ(needed_of(protocol::Role::mbd, scene), std::uint64_t{can_control})
      << "bodies alone are controlled, too";
}

std::vector<std::string> schemes(const scene::Scene& scene, std::uint64_t of_mbd, std::uint64_t of_dem) {
  return possible_schemes(scene, {{Role::mbd, "bodies 1", of_mbd}, {Role::dem, "spheres 1", of_dem}});
}

TEST(Needs, SchemesThatArePossibleFollowFromThePair) {
  EXPECT_THAT(schemes(box(), every_capability, every_capability),
              ElementsAre("parallel", "mbd_first", "dem_first", "linear_implicit", "implicit"));
  EXPECT_THAT(schemes(box(), can_predict, forward), ElementsAre("parallel", "mbd_first", "dem_first"));
  EXPECT_THAT(schemes(box(), 0, forward), ElementsAre("mbd_first"));
  EXPECT_THAT(schemes(box(), every_capability, forward | can_rollback),
              ElementsAre("parallel", "mbd_first", "dem_first", "implicit"));
  EXPECT_THAT(schemes(box(), every_capability, can_interpolate), IsEmpty()) << "no scheme without mean loads";
}

TEST(Needs, SchemesThatArePossibleFitTheOtherSettings) {
  scene::Scene scene = box();
  scene.coupling.load = scene::LoadShape::linear;
  scene.coupling.path = scene::PathShape::quadratic;
  EXPECT_THAT(schemes(scene, every_capability, every_capability), ElementsAre("dem_first", "implicit"));
  EXPECT_THAT(schemes(scene, can_predict | can_rollback, every_capability), IsEmpty());
  scene = with(scene::Scheme::implicit);
  scene.coupling.iteration.emplace();
  EXPECT_THAT(schemes(scene, can_predict, forward), ElementsAre("parallel", "mbd_first", "dem_first"))
      << "`iteration` leaves with `implicit`";
}

std::string refusal(const scene::Scene& scene, std::uint64_t of_mbd, std::uint64_t of_dem,
                    const std::vector<Need>& besides = {}) {
  try {
    expect_capabilities(scene, besides,
                        {{Role::mbd, "adams 1", of_mbd}, {Role::dem, "liggghts 3.8", of_dem}});
    return "accepted";
  } catch (const UnmetNeed& error) {
    EXPECT_EQ(error.code(), ErrorCode::scene);
    return error.what();
  }
}

TEST(Needs, ALackIsNamedWithSettingProgramAndRemedy) {
  EXPECT_EQ(refusal(box(), every_capability, every_capability), "accepted");
  EXPECT_EQ(
      refusal(with(scene::Scheme::implicit), every_capability, forward),
      "scheme 'implicit' needs rollback (save and restore), which liggghts 3.8 does not offer (these schemes "
      "are possible: parallel, mbd_first, dem_first)");
  EXPECT_THAT(
      refusal(with(scene::Scheme::implicit), can_predict, forward),
      HasSubstr("which adams 1 does not offer; scheme 'implicit' needs rollback (save and restore), which "
                "liggghts 3.8"));
  scene::Scene scene = box();
  scene.coupling.adaptive.emplace();
  EXPECT_THAT(refusal(scene, every_capability, forward),
              HasSubstr("coupling.adaptive needs rollback (save and restore), which "
                        "liggghts 3.8 does not offer (leave out coupling.adaptive)"));
  scene.coupling.scheme = scene::Scheme::implicit;
  EXPECT_THAT(
      refusal(scene, every_capability, forward),
      HasSubstr("(leave out coupling.adaptive; these schemes are possible: parallel, mbd_first, dem_first)"));
  EXPECT_THAT(
      refusal(box(), every_capability, can_interpolate),
      HasSubstr("every scene with particles needs loads that are means over a window, which liggghts 3.8 "
                "does not offer (use another solver)"));
  EXPECT_EQ(refusal(box(), every_capability, forward, {{can_checkpoint, "--restart", "start anew"}}),
            "--restart needs restart files (checkpoint and resume), which liggghts 3.8 does not offer (start "
            "anew)");
}

TEST(Needs, ResultsOfElementsAreNeededWhereACheckOrASensorUsesThem) {
  scene::Scene scene = box();
  scene.dem.reset();
  scene.checks.clear();
  const std::string joint = scene.mbd->joints.at(0).name;
  scene.mbd->forces.push_back(scene::Actuator{"motor", JointId{0}, scene::ConstantMotion{}});
  EXPECT_EQ(needed_of(protocol::Role::mbd, scene), 0u) << "elements.csv is left out";
  scene.checks.emplace_back().of = "motor.power";
  EXPECT_EQ(needed_of(protocol::Role::mbd, scene), std::uint64_t{can_observe_elements});
  EXPECT_THAT(
      refusal(scene, every_capability & ~can_observe_elements, 0),
      HasSubstr("check of 'motor.power' needs results of motors, cylinders and other elements, which "));
  scene.checks[0].of = "summary.elements.motor.power.largest";
  EXPECT_EQ(needed_of(protocol::Role::mbd, scene), std::uint64_t{can_observe_elements});
  scene.checks[0].of = joint + ".q";
  EXPECT_EQ(needed_of(protocol::Role::mbd, scene), 0u);
  scene.mbd->sensors = {"motor.power"};
  EXPECT_EQ(needed_of(protocol::Role::mbd, scene), std::uint64_t{can_observe_elements});
}

TEST(Needs, ContactsOfSpheresAreNeededWhereFramesHaveThem) {
  scene::Scene scene = box();
  scene.output.fields = {scene::SphereField::group, scene::SphereField::material};
  EXPECT_EQ(needed_of(protocol::Role::dem, scene) & can_observe_contacts, 0u)
      << "the coordinator knows them itself";
  scene.output.fields.push_back(scene::SphereField::mean_stress);
  EXPECT_EQ(needed_of(protocol::Role::dem, scene) & can_observe_contacts,
            std::uint64_t{can_observe_contacts});
  EXPECT_THAT(refusal(scene, every_capability, every_capability & ~can_observe_contacts),
              HasSubstr("output.fields 'mean_stress' needs the contacts of the spheres in frames, which "
                        "liggghts 3.8 does not offer (leave 'mean_stress' out of output.fields)"));
}

TEST(Needs, FieldsOfWallsAndContactsOfBodiesNeedTheirCapabilities) {
  scene::Scene scene = box();
  EXPECT_EQ(needed_of(protocol::Role::dem, scene) & (can_observe_contacts | can_observe_walls), 0u);
  scene.output.wall_fields = {"box"};
  EXPECT_EQ(needed_of(protocol::Role::dem, scene) & can_observe_walls, std::uint64_t{can_observe_walls});
  scene.output.contacts = {ground};
  EXPECT_EQ(needed_of(protocol::Role::dem, scene) & can_observe_contacts,
            std::uint64_t{can_observe_contacts});
}

}  // namespace
}  // namespace tandem::launch
