// Wrong models: each message names the link or joint, the fault, and the remedy.
#include "tests/unit/import/model_folder.hpp"

namespace tandem::launch {
namespace {

using Refusals = ModelFolder;
const std::string remedy = " (wiki.ros.org/urdf/XML describes the format)";

std::string inertial(const std::string& mass, const std::string& inertia) {
  return "<inertial><mass value=\"" + mass + "\"/><inertia " + inertia + "/></inertial>";
}
const std::string ones = R"(ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1")";

TEST_F(Refusals, Syntax) {
  EXPECT_EQ(refusal("<link>"), "m.urdf: Error reading end tag." + remedy);
  EXPECT_EQ(refusal(""), "m.urdf: No link elements found in urdf file" + remedy);
}

TEST_F(Refusals, ElementsOfATextThatAreNestedWithoutEnd) {
  std::string deep;
  for (int i = 0; i < 200000; ++i) deep += "<a>";
  EXPECT_EQ(
      refusal(deep),
      "m.urdf: line 1: elements are nested 200001 deep; at most 64 levels are read (close each element; a "
      "URDF model has 5 levels)");
  EXPECT_EQ(refusal("<!-- " + deep + " -->"), "m.urdf: No link elements found in urdf file" + remedy);
  EXPECT_EQ(refusal("\n<!-- " + deep), "m.urdf: line 2: a comment has no end" + remedy);
}

TEST_F(Refusals, AFileWithoutAnEnd) {
  ImportOptions options;
  options.model = "/dev/zero";
  EXPECT_THROW(import_urdf(options), Error);
}

TEST_F(Refusals, LongNames) {
  const std::string longest(1000000, 'x');
  EXPECT_LT(refusal(link(longest, inertial("1kg", ones))).size(), 600u);
  EXPECT_LT(refusal(link(longest)).size(), 600u);
}

TEST_F(Refusals, Links) {
  EXPECT_EQ(refusal(link("a") + link("a")), "m.urdf: link 'a': link 'a' is not unique." + remedy);
  EXPECT_EQ(refusal(link("a", inertial("1kg", ones))),
            "m.urdf: link 'a': Inertial: mass [1kg] is not a float" + remedy);
  EXPECT_EQ(refusal(link("a", inertial("1", R"(ixx="1")"))),
            "m.urdf: link 'a': Inertial: inertia element missing ixy attribute" + remedy);
  EXPECT_EQ(
      refusal(link("a", inertial("0", ones))),
      "m.urdf: link 'a': the mass is 0 kg (give a mass > 0, or leave out <inertial> where the link is only a "
      "frame)");
  EXPECT_EQ(refusal(link("a", inertial("1", R"(ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="3")"))),
            "m.urdf: link 'a': the principal moments are [1, 1, 3] kg m2; the largest exceeds the sum of the "
            "others "
            "(no rigid body has such an inertia)");
  EXPECT_EQ(refusal(link("a", unit_inertial + unit_inertial)),
            "m.urdf: link 'a': <inertial> is given twice (keep one of them)");
  EXPECT_EQ(refusal(link("a", "")), "m.urdf: no link has a mass (give the links that move an <inertial>)");
  EXPECT_EQ(refusal(link("the arm")),
            "m.urdf: link 'the arm': the value is \"the arm\" (give a word of letters, digits, _ "
            "and -: unique among the bodies)");
}

TEST_F(Refusals, Trees) {
  const std::string ab = link("a") + link("b");
  EXPECT_EQ(refusal(ab), "m.urdf: Failed to find root link: Two root links found: [a] and [b]" + remedy);
  EXPECT_EQ(refusal(link("a") + joint("continuous")),
            "m.urdf: link 'b': Failed to build tree: child link [b] of joint [j] not found" + remedy);
  const std::string second =
      R"(<joint name="k" type="continuous"><parent link="c"/><child link="b"/></joint>)";
  const std::string third =
      R"(<joint name="l" type="continuous"><parent link="a"/><child link="c"/></joint>)";
  EXPECT_EQ(refusal(ab + link("c") + joint("continuous") + second + third),
            "m.urdf: joint 'k': link 'b' is already the child of joint 'j' (a URDF model is a tree; close "
            "the loop in "
            "the scene by hand)");
}

TEST_F(Refusals, Joints) {
  const std::string ab = link("a") + link("b");
  EXPECT_EQ(refusal(ab + joint("hinge")), "m.urdf: joint 'j': Joint [j] has no known type [hinge]" + remedy);
  EXPECT_EQ(refusal(ab + joint("revolute")),
            "m.urdf: joint 'j': Joint [j] is of type REVOLUTE but it does not specify limits" + remedy);
  EXPECT_EQ(refusal(ab + joint("continuous", R"(<axis xyz="0 0 0"/>)")),
            "m.urdf: joint 'j': the axis is 0 0 0 (give the axis a direction)");
  EXPECT_EQ(refusal(ab + joint("continuous", R"(<dynamics damping="lots"/>)")),
            "m.urdf: joint 'j': damping value (lots) is not a valid float" + remedy);
  EXPECT_EQ(refusal(ab + joint("continuous", R"(<dynamics damping="-1"/>)")),
            "m.urdf: joint 'j': the value is -1 (give a number from 0 to 1e+18: torque or force against the "
            "rate [N m "
            "s/rad] or "
            "[N s/m])");
  EXPECT_EQ(refusal(ab + joint("planar")),
            "m.urdf: joint 'j': a planar joint cannot be imported (build it of two prismatic joints and a "
            "continuous "
            "one, with light links between them)");
  EXPECT_EQ(refusal(ab + joint("continuous", R"(<mimic joint="j"/>)")),
            "m.urdf: joint 'j': mimics joint 'j', itself (name another joint of the model)");
  EXPECT_EQ(refusal(ab + joint("continuous", R"(<mimic joint="x"/>)")),
            "m.urdf: joint 'j': mimics joint 'x', which does not exist (name another joint of the model)");
  EXPECT_EQ(refusal(ab + joint("continuous", R"(<dynamics friction="-1"/>)")),
            "m.urdf: joint 'j': the value is -1 (give a number from 0 to 1e+18: friction torque or force of "
            "the sliding joint "
            "[N m] or [N])");
  EXPECT_EQ(refusal(link("a") + link("b", "") + joint("continuous")),
            "m.urdf: link 'b': moves by joint 'j' but has no <inertial> (give it a mass and an inertia)");
}

TEST_F(Refusals, Shapes) {
  put("bed.json",
      R"({"tandem": "1.0", "name": "bed", "end_time": 1, "dem": {"materials": [{"name": "steel"}]}})");
  ImportOptions options;
  options.into = folder_ / "bed.json";
  options.materials = {"steel"};
  const auto shape = [](const std::string& geometry) {
    return link("a", unit_inertial + "<collision><geometry>" + geometry + "</geometry></collision>");
  };
  EXPECT_EQ(refusal(shape("<cone/>"), options), "m.urdf: link 'a': Unknown geometry type 'cone'" + remedy);
  EXPECT_EQ(refusal(shape(R"(<box size="1 2"/>)"), options),
            "m.urdf: link 'a': Parser found 2 elements but 3 expected while parsing vector [1 2]" + remedy);
  EXPECT_EQ(refusal(shape(R"(<mesh filename="none.stl"/>)"), options),
            "m.urdf: link 'a': none.stl: the mesh file does not exist (check the path)");
  EXPECT_EQ(refusal(shape(R"(<mesh filename="a.dae"/>)"), options),
            "m.urdf: link 'a': a.dae: the mesh format '.dae' is not supported (give an .stl or .obj file)");
  EXPECT_EQ(
      refusal(shape(R"(<mesh filename="a.stl" scale="1 1 -1"/>)"), options),
      "m.urdf: link 'a': the mesh 'a.stl' has the scale 1 1 -1 (a scene takes positive scales only: mirror "
      "the mesh itself)");
  EXPECT_EQ(refusal(shape(R"(<mesh filename="package://robots/a.stl"/>)"), options),
            "m.urdf: link 'a': the mesh 'package://robots/a.stl' is not found (there is no folder 'robots' "
            "above the "
            "model)");
  options.materials = {"stel"};
  EXPECT_EQ(refusal(shape(R"(<box size="1 1 1"/>)"), options),
            "--material: there is no material 'stel' in bed.json (did you mean 'steel'?)");
}

TEST_F(Refusals, RingsBesideTheRoot) {
  const auto between = [](const std::string& name, const std::string& parent, const std::string& child) {
    return "<joint name=\"" + name + "\" type=\"fixed\"><parent link=\"" + parent + "\"/><child link=\"" +
           child + "\"/></joint>";
  };
  EXPECT_EQ(refusal(link("a") + link("b") + link("c") + between("j", "b", "c") + between("k", "c", "b")),
            "m.urdf: link 'b': is carried by joints that form a ring, without an end at the root (a URDF "
            "model is a tree; close "
            "the loop in the scene by hand)");
}

TEST_F(Refusals, OtherEncodingThanUtf8) {
  EXPECT_EQ(refusal(link("a", "") + link("k\xf6rper")),
            "m.urdf: is not UTF-8, and its names become those of a scene (save it in that encoding)");
}

}  // namespace
}  // namespace tandem::launch
