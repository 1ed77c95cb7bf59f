// Conversion of links, joints and shapes.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/import/model_folder.hpp"

namespace tandem::launch {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Import = ModelFolder;

void expect_numbers(const nlohmann::ordered_json& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size()) << found;
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(found[i].get<double>(), expected[i], 1e-15) << found;
}

TEST_F(Import, RootIsTheGroundAndMassSitsAtItsCentre) {
  const Imported it =
      import(link("a", "") + link("b", R"(<inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
                   <inertia ixx="3" ixy="0" ixz="0" iyy="4" iyz="0" izz="5"/></inertial>)") +
             joint("continuous", R"(<origin xyz="1 2 3"/><axis xyz="0 2 0"/><dynamics damping="0.25"/>)"));
  const auto& mbd = it.scene["mbd"];
  ASSERT_EQ(mbd["bodies"].size(), 1u);
  EXPECT_EQ(mbd["bodies"][0]["mass"], 2.0);
  expect_numbers(mbd["bodies"][0]["position"], {1, 2, 2.5});
  expect_numbers(mbd["bodies"][0]["inertia"], {3, 4, 5, 0, 0, 0});
  EXPECT_EQ(mbd["joints"][0]["type"], "revolute");
  EXPECT_EQ(mbd["joints"][0]["parent"], "ground");
  EXPECT_EQ(mbd["joints"][0]["damping"], 0.25);
  expect_numbers(mbd["joints"][0]["position"], {1, 2, 3});
  expect_numbers(mbd["joints"][0]["axis"], {0, 1, 0});
  EXPECT_TRUE(it.notes.empty());
}

TEST_F(Import, RpyTurnsAboutFixedAxesRollFirst) {
  // R = Rz(pi/2) Ry(0) Rx(pi/2): x goes to y, y to z, z to x.
  const Imported it = import(link("a", "") + link("b") +
                             joint("prismatic", R"(<origin rpy="1.5707963267948966 0 1.5707963267948966"/>
                                   <axis xyz="0 0 1"/><limit lower="0" upper="0" effort="0" velocity="0"/>)"));
  expect_numbers(it.scene["mbd"]["joints"][0]["axis"], {1, 0, 0});
  expect_numbers(it.scene["mbd"]["bodies"][0]["orientation"], {0.5, 0.5, 0.5, 0.5});
  EXPECT_TRUE(it.notes.empty());
}

TEST_F(Import, InertiaOfATurnedOriginIsGivenInTheAxesOfTheLink) {
  // A rotation by 90 degrees about z exchanges xx and yy, and changes the sign of xy.
  const Imported it =
      import(link("a", "") + link("b", R"(<inertial><origin rpy="0 0 1.5707963267948966"/><mass value="1"/>
                                 <inertia ixx="1" ixy="0.1" ixz="0.2" iyy="2" iyz="0.3" izz="2.5"/></inertial>)") +
             joint("continuous"));
  // R (x,y,z) = (-y,x,z): xz' = -yz, yz' = xz.
  expect_numbers(it.scene["mbd"]["bodies"][0]["inertia"], {2, 1, 2.5, -0.1, -0.3, 0.2});
}

TEST_F(Import, LinkWithoutMassIsAFrameOfTheLinkThatItIsFixedTo) {
  const Imported it = import(
      link("a", "") + link("b") + link("tool", "") + link("tip") + joint("continuous") +
      R"(<joint name="t" type="fixed"><origin xyz="1 0 0"/><parent link="b"/><child link="tool"/></joint>
                <joint name="s" type="continuous"><origin xyz="0 1 0"/><parent link="tool"/><child link="tip"/></joint>)");
  const auto& joints = it.scene["mbd"]["joints"];
  ASSERT_EQ(joints.size(), 2u);
  EXPECT_EQ(joints[1]["name"], "s");
  EXPECT_EQ(joints[1]["parent"], "b");
  expect_numbers(joints[1]["position"], {1, 1, 0});
}

TEST_F(Import, RootWithMassIsFixedOrFree) {
  const std::string elements = link("a") + link("b") + joint("fixed");
  const Imported fixed = import(elements);
  EXPECT_EQ(fixed.scene["mbd"]["joints"][0]["name"], "a_to_ground");
  EXPECT_EQ(fixed.scene["mbd"]["joints"][1]["type"], "fixed");
  ImportOptions options;
  options.free_root = true;
  EXPECT_EQ(import(elements, options).scene["mbd"]["joints"].size(), 1u);
}

TEST_F(Import, WhatASceneCannotSayIsTold) {
  const Imported it = import(
      link("a", "") + link("b", unit_inertial + R"(<visual><geometry><sphere radius="1"/></geometry></visual>
               <collision><geometry><sphere radius="1"/></geometry></collision><lamp/>)") +
      joint("revolute",
            R"(<limit lower="-1" upper="2" effort="30" velocity="4" soft="1"/>
               <safety_controller k_velocity="1"/><calibration rising="0"/>)") +
      "<gazebo/>");
  EXPECT_THAT(
      it.notes,
      ElementsAre(
          "link 'b': <lamp> is no part of URDF",
          "joint 'j': attribute soft=\"1\" of <limit> is no part of URDF", "<gazebo> is no part of URDF",
          "joint 'j': limits -1 to 2 rad: URDF does not say how stiff the stops are: import with --stops, "
          "or add \"limits\": {\"lower\": -1, \"upper\": 2, \"stiffness\": ...}",
          "joint 'j': effort limit 30 N m: there is no drive to limit",
          "joint 'j': velocity limit 4 rad/s: there is no drive to limit",
          "joint 'j': <safety_controller>: a scene has no controllers",
          "joint 'j': <calibration>: a scene has no encoders",
          "link 'b': <visual>: a scene draws the walls, made of <collision>"));
}

TEST_F(Import, ShapesStayForPicturesWithoutParticles) {
  put("tetra.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const Imported it = import(link("a", R"(<collision><geometry><box size="1 1 1"/></geometry></collision>)") +
                             link("b", R"(<inertial><origin xyz="0 0 0.5"/><mass value="1"/>
                   <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
                   <visual><origin xyz="1 0 0"/><geometry><mesh filename="tetra.obj"/></geometry></visual>
                   <visual><geometry><mesh filename="package://none/x.stl"/></geometry></visual>)") +
                             joint("continuous", ""));
  const auto& shapes = it.scene["mbd"]["bodies"][0]["shapes"];
  ASSERT_EQ(shapes.size(), 1u);
  EXPECT_EQ(shapes[0]["use"], "graphics");
  EXPECT_EQ(shapes[0]["shape"]["file"], "tetra.obj");
  expect_numbers(shapes[0]["position"], {1, 0, -0.5});
  EXPECT_THAT(it.notes,
              ElementsAre("link 'a': <collision>: walls need particles, import --into a scene that has some",
                          HasSubstr("link 'b': the mesh 'package://none/x.stl' is not found")));
}

TEST_F(Import, LimitsBecomeStopsOfTheStiffnessThatIsGiven) {
  ImportOptions options;
  options.stops = StopStiffness{5e3, 2e6};
  const auto limits = [&](const std::string& type, const std::string& range) {
    const Imported it =
        import(link("a", "") + link("b") + joint(type, "<limit " + range + R"( effort="0" velocity="0"/>)"),
               options);
    const auto& entry = it.scene["mbd"]["joints"][0];
    return entry.contains("limits") ? entry["limits"].dump() : it.notes.empty() ? "none" : it.notes[0];
  };
  EXPECT_EQ(limits("revolute", R"(lower="-1" upper="2")"),
            R"({"lower":-1.0,"upper":2.0,"stiffness":5000.0})");
  EXPECT_EQ(limits("prismatic", R"(lower="0" upper="0.5")"),
            R"({"lower":0.0,"upper":0.5,"stiffness":2000000.0})");
  EXPECT_EQ(limits("continuous", R"(lower="-1" upper="2")"), "none");
  EXPECT_EQ(limits("revolute", R"(lower="0" upper="0")"), "none");
  EXPECT_EQ(limits("revolute", R"(lower="0.5" upper="2")"),
            "joint 'j': limits 0.5 to 2 rad: the model starts at zero, beyond them, where a stop would throw "
            "it back");
}

TEST_F(Import, DryFrictionIsTakenOver) {
  const std::string friction = R"(<dynamics damping="0.5" friction="0.1"/>)";
  const Imported moves = import(link("a", "") + link("b") + joint("continuous", friction));
  EXPECT_EQ(moves.scene["mbd"]["joints"][0]["friction"].dump(), R"({"force":0.1,"slip":0.001})");
  EXPECT_EQ(moves.scene["mbd"]["joints"][0]["damping"], .5);
  EXPECT_TRUE(moves.notes.empty());
  const Imported fixed = import(link("a", "") + link("b") + joint("fixed", friction));
  EXPECT_THAT(fixed.notes, ElementsAre("joint 'j': damping 0.5: a fixed joint has none",
                                       "joint 'j': friction 0.1: a fixed joint has none"));
}

TEST_F(Import, MimickingJointsAreCoupled) {
  const auto pair = [&](const std::string& leader, const std::string& follower, const std::string& mimic) {
    const auto limit = [](const std::string& type) {
      return type == "prismatic" ? R"(<limit lower="0" upper="0" effort="0" velocity="0"/>)" : "";
    };
    const Imported it =
        import(link("a", "") + link("b") + link("c") + joint(leader, limit(leader)) +
               R"(<joint name="k" type=")" + follower + R"("><parent link="a"/><child link="c"/>)" +
               limit(follower) + "<mimic " + mimic + "/></joint>");
    const auto& mbd = it.scene["mbd"];
    return mbd.contains("couplers") ? mbd["couplers"][0].dump() : it.notes.at(0);
  };
  EXPECT_EQ(pair("continuous", "continuous", R"(joint="j" multiplier="-2")"),
            R"({"name":"k","type":"gear","joint_a":"j","joint_b":"k","ratio":-2.0})");
  EXPECT_EQ(pair("continuous", "prismatic", R"(joint="j" multiplier="0.1")"),
            R"({"name":"k","type":"rack_and_pinion","joint_a":"j","joint_b":"k","ratio":0.1})");
  EXPECT_EQ(pair("prismatic", "continuous", R"(joint="j" multiplier="8")"),
            R"({"name":"k","type":"rack_and_pinion","joint_a":"k","joint_b":"j","ratio":0.125})");
  const std::string told = "joint 'k': mimic of joint 'j' (multiplier ";
  EXPECT_EQ(pair("prismatic", "prismatic", R"(joint="j")"),
            told + "1, offset 0): a scene has no coupler of two sliding joints");
  EXPECT_EQ(pair("continuous", "continuous", R"(joint="j" offset="0.2")"),
            told + "1, offset 0.2): couplers tie the travel from the start, where all coordinates are zero");
  EXPECT_EQ(pair("continuous", "continuous", R"(joint="j" multiplier="0")"),
            told + "0, offset 0): it does not move: make it a fixed joint");
  EXPECT_EQ(pair("continuous", "fixed", R"(joint="j")"),
            told + "1, offset 0): one of them has no coordinate in the scene");
}

constexpr const char* bed = R"({"tandem": "1.0", "name": "bed", "end_time": 1, "dem": {
  "materials": [{"name": "steel", "density": 7800, "young": 1e7, "poisson": 0.3}],
  "pairs": [{"a": "steel", "b": "steel", "restitution": 0.5, "friction": 0.3}],
  "particles": [{"name": "p", "material": "steel", "radius": 0.1,
    "fill": {"type": "lattice", "min": [5,5,5], "max": [6,6,6], "spacing": 0.25}}],
  "domain": {"min": [-9,-9,-9], "max": [9,9,9]}}})";

TEST_F(Import, CollisionShapesBecomeWalls) {
  put("bed.json", bed);
  put("tetra.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  ImportOptions options;
  options.into = folder_ / "bed.json";
  options.materials = {"steel"};
  const std::string mass = R"(<inertial><origin xyz="0 0 0.5"/><mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>)";
  const std::string name = folder_.filename().string();
  const Imported it = import(
      link("a",
           R"(<collision><origin xyz="0 0 -1"/><geometry><box size="2 2 0.1"/></geometry></collision>)") +
          link("b",
               mass +
                   R"(<collision><origin xyz="1 0 0"/><geometry><cylinder radius="0.1" length="2"/></geometry>
              </collision><collision><geometry><mesh filename="package://)" +
                   name +
                   R"(/tetra.obj" scale="0.1 0.2 0.05"/></geometry></collision>
              <collision><geometry><sphere radius="1"/></geometry></collision>)") +
          joint("continuous", R"(<origin rpy="0 0 1.5707963267948966"/>)"),
      options);
  const auto& walls = it.scene["dem"]["walls"];
  ASSERT_EQ(walls.size(), 4u);
  EXPECT_EQ(walls[0]["body"], "ground");
  expect_numbers(walls[0]["position"], {0, 0, -1});
  EXPECT_EQ(walls[1]["name"], "b_1");
  EXPECT_EQ(walls[1]["body"], "b");
  expect_numbers(walls[1]["position"], {1, 0, -0.5});
  expect_numbers(walls[1]["orientation"], {1, 0, 0, 0});
  EXPECT_EQ(walls[1]["shape"]["height"], 2.0);
  EXPECT_EQ(walls[2]["shape"]["file"], "tetra.obj");
  EXPECT_EQ(walls[2]["shape"]["scale"], 0.1);
  expect_numbers(walls[2]["shape"]["stretch"], {1, 2, 0.5});
  EXPECT_EQ(walls[3]["shape"], (nlohmann::ordered_json{{"type", "sphere"}, {"radius", 1.0}}));
  EXPECT_THAT(it.notes, testing::IsEmpty());
}

}  // namespace
}  // namespace tandem::launch
