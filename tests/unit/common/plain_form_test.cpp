// Orientations, degrees and relative poses.
#include "common/scene/plain_form.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "common/scene/parse.hpp"
#include "tests/unit/common/good_scene.hpp"

namespace tandem::scene {
namespace {

using nlohmann::json;

Quat orientation_of(const json& orientation) {
  json scene = test::good_scene();
  scene["mbd"]["bodies"][0]["orientation"] = orientation;
  const Scene parsed = parse(scene.dump(), "scene.json");
  validate(parsed, "scene.json");
  return parsed.mbd->bodies[0].pose.q_WB;
}

double distance(Quat a, Quat b) {
  return norm(rotation_vector(a.conjugate() * b));
}

Mat3d elementary(char axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  if (axis == 'x') return {{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
  if (axis == 'y') return {{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
  return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
}

// Intrinsic rotations: the matrices stand in the order of the angles.
TEST(Orientations, EulerAnglesInEveryOrder) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(-180, 180);
  for (const std::string order :
       {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"}) {
    double degrees[3], radians[3];
    for (int k = 0; k < 3; ++k) {
      degrees[k] = angle(random);
      radians[k] = degrees[k] * std::numbers::pi / 180;
    }
    const Quat q = orientation_of({{"euler_deg", degrees}, {"order", order}});
    for (const Vec3d v : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
      const Vec3d expected = elementary(order[0], radians[0]) *
                             (elementary(order[1], radians[1]) * (elementary(order[2], radians[2]) * v));
      EXPECT_LT(norm(q.rotate(v) - expected), 1e-14) << order;
    }
    EXPECT_LT(distance(q, orientation_of({{"euler", radians}, {"order", order}})), 1e-14);
  }
  EXPECT_LT(distance(orientation_of({{"euler_deg", {90, 0, 0}}, {"order", "zyx"}}),
                     {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}),
            1e-15);
}

TEST(Orientations, AxisAndAngle) {
  EXPECT_LT(distance(orientation_of({{"axis", {0, 0.6, 0.8}}, {"angle_deg", 60}}),
                     exp(Vec3d{0, 0.6, 0.8} * (std::numbers::pi / 3))),
            1e-15);
  EXPECT_LT(distance(orientation_of({{"axis", {0, 0, 1}}, {"angle", 7}}), exp({0, 0, 7})), 1e-14);
}

TEST(Orientations, AnyTwoAxesOfAnyLength) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  const char* keys[3] = {"x_axis", "y_axis", "z_axis"};
  for (int trial = 0; trial < 50; ++trial) {
    const Quat q = Quat{normal(random), normal(random), normal(random), normal(random)}.normalized();
    for (int left_out = 0; left_out < 3; ++left_out) {
      json axes = json::object();
      for (int k = 0; k < 3; ++k) {
        Vec3d unit;
        unit[k] = 1;
        const Vec3d axis = (0.1 + k) * q.rotate(unit);
        if (k != left_out) axes[keys[k]] = {axis.x, axis.y, axis.z};
      }
      EXPECT_LT(distance(orientation_of(axes), q), 1e-14);
    }
  }
}

TEST(Degrees, WhereTheKeySaysSo) {
  json scene = test::good_scene();
  json& hinge = scene["mbd"]["joints"][1];
  hinge["limits"] = {{"lower_deg", -90}, {"upper_deg", 180}, {"stiffness", 1}};
  hinge["motion"] = {{"type", "harmonic"}, {"amplitude_deg", 45}, {"frequency", 1}, {"phase_deg", 180}};
  scene["mbd"]["forces"][1].erase("angle");
  scene["mbd"]["forces"][1]["angle_deg"] = 180;
  const auto joint = [&] { return parse(scene.dump(), "scene.json").mbd->joints[1]; };
  const double pi = std::numbers::pi;
  EXPECT_EQ(joint().limits->lower, -pi / 2);
  EXPECT_EQ(joint().limits->upper, pi);
  EXPECT_EQ(std::get<HarmonicMotion>(*joint().motion).amplitude, pi / 4);
  EXPECT_EQ(std::get<HarmonicMotion>(*joint().motion).phase, pi);
  EXPECT_EQ(std::get<RotationalSpringDamper>(parse(scene.dump(), "scene.json").mbd->forces[1]).angle, pi);
  hinge["motion"] = {{"type", "table"}, {"times", {0, 1}}, {"values_deg", {0, 90}}, {"offset_deg", 90}};
  EXPECT_EQ(std::get<TableMotion>(*joint().motion).values[1], pi / 2);
  EXPECT_EQ(std::get<TableMotion>(*joint().motion).offset, pi / 2);
  hinge["motion"] = {{"type", "ramp"}, {"from_deg", 90}, {"to_deg", 180}, {"duration", 1}};
  EXPECT_EQ(std::get<RampMotion>(*joint().motion).from, pi / 2);
  EXPECT_EQ(std::get<RampMotion>(*joint().motion).to, pi);
  hinge["motion"] = {{"type", "constant"}, {"value_deg", 90}, {"rate_deg", 360}};
  EXPECT_EQ(std::get<ConstantMotion>(*joint().motion).value, pi / 2);
  EXPECT_EQ(std::get<ConstantMotion>(*joint().motion).rate, 2 * pi);
  hinge.erase("motion");
  hinge["rate_deg"] = 18;
  EXPECT_EQ(joint().rate, pi / 10);
}

TEST(Degrees, OfTargetsOfMotors) {
  json scene = test::good_scene();
  json& motor = scene["mbd"]["forces"][0];
  motor = {{"name", "m"},
           {"type", "motor"},
           {"joint", "hinge"},
           {"control", "position"},
           {"gains", {{"proportional", 1}}},
           {"target", {{"type", "constant"}, {"value_deg", 90}}}};
  scene["mbd"]["joints"][1].erase("motion");
  const auto target = [&] {
    return std::get<Motor>(parse(scene.dump(), "scene.json").mbd->forces[0]).target;
  };
  const double pi = std::numbers::pi;
  EXPECT_EQ(std::get<ConstantMotion>(target()).value, pi / 2);
  motor["target"] = {{"type", "ramp"}, {"from_deg", 90}, {"to_deg", 180}, {"duration", 1}};
  EXPECT_EQ(std::get<RampMotion>(target()).from, pi / 2);
  EXPECT_EQ(std::get<RampMotion>(target()).to, pi);
  motor["target"] = {{"type", "table"}, {"times", {0, 1}}, {"values_deg", {0, 90}}};
  EXPECT_EQ(std::get<TableMotion>(target()).values[1], pi / 2);
}

// A table that begins at 180 degrees, in degrees and with an offset.
TEST(Degrees, OfSizesOverAnAngle) {
  json scene = test::good_scene();
  scene["mbd"]["forces"][0] = {{"name", "gas"},
                               {"type", "actuator"},
                               {"joint", "slide"},
                               {"over",
                                {{"joint", "hinge"},
                                 {"arguments_deg", {0, 90, 720}},
                                 {"values", {1, 2, 1}},
                                 {"period_deg", 720},
                                 {"offset_deg", 180}}}};
  const Scene parsed = parse(scene.dump(), "scene.json");
  const JointFunction& over = *std::get<Actuator>(parsed.mbd->forces[0]).over;
  const double pi = std::numbers::pi;
  EXPECT_EQ(over.table.arguments, (std::vector<double>{pi, 1.5 * pi, 5 * pi}));
  EXPECT_EQ(*over.period, 4 * pi);
  EXPECT_FALSE(parsed.is_plain);
  scene["mbd"]["forces"][0]["over"] = {
      {"joint", "hinge"}, {"arguments", {0, 1}}, {"values", {1, 2}}, {"offset", 2}};
  EXPECT_EQ(std::get<Actuator>(parse(scene.dump(), "scene.json").mbd->forces[0]).over->table.arguments,
            (std::vector<double>{2, 3}));
}

// The points of a local force are in the frames of the bodies that hold them.
TEST(LocalForces, HaveTheirPointsInTheirBodies) {
  json scene = test::good_scene();
  scene["mbd"]["bodies"][1]["orientation"] = {{"axis", {0, 1, 0}}, {"angle_deg", -90}};
  json& forces = scene["mbd"]["forces"];
  forces = json::array();
  forces.push_back({{"name", "jack"},
                    {"type", "cylinder"},
                    {"local", true},
                    {"body_a", "crate"},
                    {"point_a", {0.1, 0.2, 0.3}},
                    {"body_b", "arm"},
                    {"point_b", {0.5, 0.2, 0.25}},
                    {"control", "force"},
                    {"target", {{"type", "constant"}, {"value", 1}}}});
  forces.push_back({{"name", "tow"},
                    {"type", "rope"},
                    {"local", true},
                    {"points", {{{"point", {1, 2, 3}}}, {{"body", "arm"}, {"point", {0, 0, 1}}}}},
                    {"length", 1},
                    {"axial_stiffness", 1}});
  forces.push_back({{"name", "push"},
                    {"type", "force"},
                    {"local", true},
                    {"body", "arm"},
                    {"point", {0, 0, 1}},
                    {"direction", {1, 0, 0}},
                    {"size", {{"type", "constant"}, {"value", 1}}}});
  forces.push_back({{"name", "free"},
                    {"type", "rope"},
                    {"local", false},
                    {"points", {{{"point", {1, 2, 3}}}, {{"body", "arm"}, {"point", {0, 0, 1}}}}},
                    {"length", 1},
                    {"axial_stiffness", 1}});
  const Scene parsed = parse(scene.dump(), "scene.json");
  EXPECT_FALSE(parsed.is_plain);
  const auto expect_at = [](Vec3d found, Vec3d expected) { EXPECT_LT(norm(found - expected), 1e-15); };
  // The crate is at (0, 0, 1); the x axis of the arm at (1, 0, 1) points up, its z axis along -x.
  const auto& jack = std::get<Cylinder>(parsed.mbd->forces[0]);
  expect_at(jack.point_a, {0.1, 0.2, 1.3});
  expect_at(jack.point_b, {0.75, 0.2, 1.5});
  const auto& tow = std::get<Rope>(parsed.mbd->forces[1]);
  expect_at(tow.points[0].point, {1, 2, 3});
  expect_at(tow.points[1].point, {0, 0, 1});
  const auto& push = std::get<BodyLoad>(parsed.mbd->forces[2]);
  expect_at(push.point, {0, 0, 1});
  expect_at(push.direction, {0, 0, 1});
  expect_at(std::get<Rope>(parsed.mbd->forces[3]).points[1].point, {0, 0, 1});
}

// A crate, an arm on the crate, a ball on the arm, and everything that can be relative to a body, under any
// pose of the crate.
TEST(RelativePoses, FollowTheirBody) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20; ++trial) {
    const Quat q = Quat{normal(random), normal(random), normal(random), normal(random)}.normalized();
    const Vec3d p{normal(random), normal(random), normal(random)};
    json scene = test::good_scene();
    json& bodies = scene["mbd"]["bodies"];
    bodies[0]["position"] = {p.x, p.y, p.z};
    bodies[0]["orientation"] = {q.w, q.x, q.y, q.z};
    // In the order of the file the ball comes before the body to which it is relative.
    bodies[2]["relative_to"] = "arm";
    bodies[2]["position"] = {0, 0, 2};
    bodies[1]["relative_to"] = "crate";
    bodies[1]["position"] = {1, 0, 0};
    bodies[1]["orientation"] = {{"axis", {0, 0, 1}}, {"angle_deg", 90}};
    std::swap(bodies[1], bodies[2]);
    json& hinge = scene["mbd"]["joints"][1];
    hinge["relative_to"] = "arm";
    hinge["position"] = {0, 3, 0};
    hinge["child_position"] = {0, 4, 0};
    hinge["axis"] = {1, 0, 0};
    json& walls = scene["dem"]["walls"];
    walls[0]["relative_to"] = "ground";
    walls[0]["position"] = {5, 6, 7};
    walls[2]["relative_to"] = "crate";
    walls[2]["position"] = {1, 1, 0};
    walls[2].erase("orientation");
    bodies[0]["shapes"] = {{{"name", "nose"},
                            {"use", "graphics"},
                            {"relative_to", "arm"},
                            {"position", {0, 1, 0}},
                            {"shape", {{"type", "sphere"}, {"radius", 1}}}}};
    const Scene parsed = parse(scene.dump(), "scene.json");
    validate(parsed, "scene.json");
    const auto at = [&](Vec3d v) { return p + q.rotate(v); };
    const Quat quarter = exp({0, 0, std::numbers::pi / 2});
    const Mbd& mbd = *parsed.mbd;
    EXPECT_LT(norm(mbd.bodies[2].pose.p_WB - at({1, 0, 0})), 1e-14);
    EXPECT_LT(distance(mbd.bodies[2].pose.q_WB, q * quarter), 1e-14);
    EXPECT_LT(norm(mbd.bodies[1].pose.p_WB - at({1, 0, 2})), 1e-14);
    EXPECT_LT(distance(mbd.bodies[1].pose.q_WB, q * quarter), 1e-14);
    EXPECT_LT(norm(mbd.joints[1].position - at({-2, 0, 0})), 1e-14);
    EXPECT_LT(norm(*mbd.joints[1].child_position - at({-3, 0, 0})), 1e-14);
    EXPECT_LT(norm(mbd.joints[1].axis - q.rotate({0, 1, 0})), 1e-14);
    // The wall 'inside' is on the crate, and given in the world.
    EXPECT_LT(norm(at(parsed.dem->walls[0].pose.p_WB) - Vec3d{5, 6, 7}), 1e-13);
    EXPECT_LT(distance(q * parsed.dem->walls[0].pose.q_WB, {}), 1e-14);
    // The wall 'post' is on the arm, and given in the crate.
    EXPECT_LT(norm(parsed.dem->walls[2].pose.p_WB - Vec3d{1, 0, 0}), 1e-14);
    EXPECT_LT(distance(parsed.dem->walls[2].pose.q_WB, quarter.conjugate()), 1e-14);
    ASSERT_EQ(parsed.shapes.size(), 4u);
    EXPECT_LT(norm(parsed.shapes[3].pose.p_WB - Vec3d{0, 0, 0}), 1e-14);
    EXPECT_LT(distance(parsed.shapes[3].pose.q_WB, quarter), 1e-14);
    EXPECT_FALSE(parsed.is_plain);
  }
}

TEST(PlainForm, ChangesNoSceneThatIsPlain) {
  json scene = test::good_scene();
  const json before = scene;
  EXPECT_FALSE(to_plain_form(scene, "scene.json"));
  EXPECT_EQ(scene, before);
  EXPECT_TRUE(parse(scene.dump(), "scene.json").is_plain);
}

}  // namespace
}  // namespace tandem::scene
