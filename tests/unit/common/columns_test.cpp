#include "common/scene/columns.hpp"

#include <gmock/gmock.h>

#include "common/scene/element_columns.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/sensor_columns.hpp"
#include "tests/support/page_table.hpp"
#include "tests/unit/common/good_scene.hpp"

namespace tandem::scene {
namespace {

using testing::Contains;
using testing::Not;

TEST(Columns, OfBodiesAndJoints) {
  Scene scene = parse(test::good_scene_text, "scene.json");
  EXPECT_EQ(body_columns(scene).size(), 4u * (3 + 4 + 3 + 3 + 3 + 3) + 6);
  EXPECT_THAT(body_columns(scene), Contains("crate.orientation.w"));
  EXPECT_THAT(body_columns(scene), Contains("ground.contact_torque.z"));
  EXPECT_EQ(joint_columns(scene).size(), 3u * 9);
  EXPECT_THAT(joint_columns(scene), Contains("hinge.q"));

  scene.dem.reset();
  EXPECT_THAT(body_columns(scene), Not(Contains("crate.contact_force.x")));
  EXPECT_THAT(body_columns(scene), Not(Contains("ground.contact_force.x")));
}

Scene geared() {
  Scene scene;
  Mbd& mbd = scene.mbd.emplace();
  mbd.joints.resize(2);
  Joint &axle = mbd.joints[0], &rail = mbd.joints[1];
  axle.name = "axle", axle.type = JointType::revolute, axle.child = {0};
  rail.name = "rail", rail.type = JointType::prismatic, rail.child = {1};
  return scene;
}

TEST(ElementColumns, AreThoseOfForcesCouplersAndDrivenJoints) {
  Scene scene = geared();
  EXPECT_THAT(element_columns(scene), testing::IsEmpty());
  EXPECT_THAT(element_columns(Scene{}), testing::IsEmpty());
  Mbd& mbd = *scene.mbd;
  mbd.joints[0].motion = ConstantMotion{0, 1};
  mbd.joints[1].friction = Friction{2, 1e-3};
  mbd.couplers.push_back({"rack", CouplerType::rack_and_pinion, JointId{0}, JointId{1}, .1});
  mbd.forces.push_back(Actuator{"push", JointId{1}, ConstantMotion{}});
  EXPECT_EQ(
      element_columns(scene),
      (std::vector<std::string>{"axle.torque", "axle.speed", "axle.power", "axle.energy", "rail.loss_power",
                                "rail.loss_energy", "rack.torque.axle", "rack.force.rail", "rack.power",
                                "push.force", "push.velocity", "push.power", "push.energy"}));
  const std::vector<ElementOfScene> elements = elements_of(scene);
  EXPECT_EQ(elements[2].kind, "rack_and_pinion");
  EXPECT_STREQ(unit(elements[2].columns[1].channel), "N");
  EXPECT_EQ(elements[2].columns[1].part, 1);
}

TEST(ElementColumns, OutputsOfContactsAreLast) {
  Scene scene = geared();
  scene.contact.emplace();
  scene.contact->outputs.push_back({"feet", {{BodyId{0}, ""}}, {}});
  EXPECT_EQ(element_columns(scene),
            (std::vector<std::string>{"feet.force.x", "feet.force.y", "feet.force.z", "feet.torque.x",
                                      "feet.torque.y", "feet.torque.z", "feet.friction.x", "feet.friction.y",
                                      "feet.friction.z", "feet.normal_force", "feet.depth", "feet.points",
                                      "feet.centre.x", "feet.centre.y", "feet.centre.z", "feet.power",
                                      "feet.stored_energy", "feet.loss_energy"}));
  EXPECT_EQ(elements_of(scene).back().kind, "contact");
}

TEST(ElementColumns, OfASharedNameHaveTheirType) {
  Scene scene = geared();
  scene.mbd->couplers.push_back({"axle", CouplerType::gear, JointId{0}, JointId{1}});
  scene.mbd->forces.push_back(Actuator{"axle", JointId{0}, ConstantMotion{}});
  EXPECT_THAT(element_columns(scene),
              testing::ElementsAre("gear:axle.torque.axle", "gear:axle.force.rail", "gear:axle.power",
                                   "actuator:axle.torque", "actuator:axle.speed", "actuator:axle.power",
                                   "actuator:axle.energy"));
}

TEST(ElementColumns, ThePageHasTheChannels) {
  tandem::test::expect_on_page("docs/results.md", "element channels", element_channels_as_markdown());
}
TEST(SensorColumns, ThePageHasTheChannels) {
  tandem::test::expect_on_page("docs/results.md", "sensor channels", sensor_channels_as_markdown());
}

TEST(SensorColumns, OfAWallAreItsLoads) {
  Scene scene;
  scene.dem.emplace();
  ParticleSensor& sensor = scene.dem->sensors.emplace_back();
  sensor.name = "on_gate";
  sensor.wall = "gate";
  EXPECT_EQ(
      sensor_columns(scene),
      (std::vector<std::string>{"on_gate.force.x", "on_gate.force.y", "on_gate.force.z",
                                "on_gate.normal_force", "on_gate.shear_force", "on_gate.friction_power"}));
}

TEST(SensorColumns, FlowOnlyWhereTheSensorHasAnAxis) {
  Scene scene;
  EXPECT_THAT(sensor_columns(scene), testing::IsEmpty());
  scene.dem.emplace();
  scene.dem->sensors = {{"a", ground, {}, BoxShape{{1, 2, 4}, {}}, {}},
                        {"b", ground, {}, BoxShape{{1, 2, 4}, {}}, 1}};
  const std::vector<std::string> columns = sensor_columns(scene);
  EXPECT_EQ(columns.size(), 24u);
  EXPECT_THAT(columns, testing::Not(testing::Contains("a.flow")));
  EXPECT_THAT(columns,
              testing::IsSupersetOf({"a.mass", "a.momentum.z", "b.solid_fraction", "b.flow", "b.passed"}));
  EXPECT_EQ(volume_of(scene.dem->sensors[0]), 8);
  EXPECT_EQ(flow_length(scene.dem->sensors[1]), 2);
}

TEST(Columns, ControlInputsOnceInTheirOrder) {
  Mbd mbd;
  for (const char* input : {"b", "", "a", "b"})
    mbd.forces.push_back(Actuator{"m", JointId{0}, ConstantMotion{}, input});
  EXPECT_EQ(control_inputs(mbd), (std::vector<std::string>{"b", "a"}));
}

}  // namespace
}  // namespace tandem::scene
