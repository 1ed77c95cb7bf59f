#include "common/scene/columns.hpp"

#include <gmock/gmock.h>

#include "common/scene/parse.hpp"
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

TEST(Columns, ControlInputsOnceInTheirOrder) {
  Mbd mbd;
  for (const char* input : {"b", "", "a", "b"})
    mbd.forces.push_back(Actuator{"m", JointId{0}, ConstantMotion{}, input});
  EXPECT_EQ(control_inputs(mbd), (std::vector<std::string>{"b", "a"}));
}

}  // namespace
}  // namespace tandem::scene
