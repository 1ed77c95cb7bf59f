// Forces and points of contacts as results, against statics and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/scene/element_columns.hpp"
#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd {
namespace {

using namespace contacts;
using scene::ContactSide;

// The columns of elements.csv at an instant of a run.
struct Seen {
  std::vector<std::string> columns;
  std::vector<double> values;

  Seen(const scene::Scene& scene, ContactRun& run)
      : columns(scene::element_columns(scene)), values(run.solver.observe().elements) {}
  double operator[](const std::string& column) const {
    const auto found = std::ranges::find(columns, column);
    EXPECT_NE(found, columns.end()) << column;
    return found == columns.end() ? NAN : values.at(static_cast<std::size_t>(found - columns.begin()));
  }
  Vec3d vector(const std::string& channel) const {
    return {(*this)[channel + ".x"], (*this)[channel + ".y"], (*this)[channel + ".z"]};
  }
};

void expect_vector(const std::string& what, Vec3d measured, Vec3d expected, double tolerance) {
  for (int axis = 0; axis < 3; ++axis)
    expect_near(what + "." + "xyz"[axis], measured[axis], expected[axis], tolerance);
}

// The weight of a box at rest on a slope: friction holds its part along the slope, and the floor pushes below
// the point where the weight acts.
TEST(ContactOutputs, BoxAtRestOnASlope) {
  const double m = 2, along = 3, down = 9;
  ContactScene s({along, 0, -down});
  s.add_floor();
  const BodyId box = s.add_box("box", m, {0.2, 0.2, 0.1}, {0, 0, 0.05});
  s.material() = {"stuff", 1e6, 0, 0, 0.2, 0.5};
  s.scene.contact->outputs = {{"feet", {{box, ""}}, {}}, {"load", {{ground, "floor"}}, {{box, "box"}}}};
  ContactRun run(s.scene, 0.1);
  run.advance(100);
  const Seen seen(s.scene, run);
  const Vec3d place = run.position();
  expect_vector("force", seen.vector("feet.force"), {-m * along, 0, m * down}, 1e-8);
  expect_vector("friction", seen.vector("feet.friction"), {-m * along, 0, 0}, 1e-4);
  expect_vector("torque about the centre of mass", seen.vector("feet.torque"), {0, 0, 0}, 1e-8);
  expect_near("normal_force", seen["feet.normal_force"], m * down, 1e-3);
  EXPECT_EQ(seen["feet.points"], 4);
  // The line of the weight meets the floor at place + (0.05 along / down, 0).
  expect_vector("centre - box", seen.vector("feet.centre") - place, {0.05 * along / down, 0, -0.05}, 1e-4);
  // Two of four springs at 0.2 m bear the moment m along 0.05.
  const double deepest = (m * down / 4 + m * along * 0.05 / 0.2 / 2) / 1e6;
  expect_near("depth", seen["feet.depth"], deepest, 2e-3 * deepest);
  expect_near("power", seen["feet.power"], 0, 1e-9);
  expect_vector("force on the floor", seen.vector("load.force"), {m * along, 0, -m * down}, 1e-8);
  expect_vector("torque on the floor about the world's origin", seen.vector("load.torque"),
                cross(place, {m * along, 0, -m * down}), 1e-7);
}

// The largest force and depth of an impact without damping, and what an impact with damping dissipates.
TEST(ContactOutputs, Impact) {
  for (const double e : {1.0, 0.5}) {
    const double m = 1, k = 1e6, v = 2, R = 0.05;
    ContactScene s({0, 0, 0});
    s.add_floor();
    const BodyId ball = s.add_ball("ball", m, R, {0, 0, R + 0.01});
    s.body(ball).twist.v_WB = {0, 0, -v};
    s.material() = {"stuff", k, 0, 0, e, 0};
    s.scene.contact->outputs = {{"bounce", {{ball, ""}}, {}}};
    ContactRun run(s.scene, 1e-3);
    run.advance(20);
    const Seen seen(s.scene, run);
    const nlohmann::json facts = run.facts();
    const double lost = 0.5 * m * v * v * (1 - e * e);
    expect_near("loss_energy", seen["bounce.loss_energy"], lost, 5e-3 * 0.5 * m * v * v);
    EXPECT_EQ(seen["bounce.loss_energy"], facts.at("mbd_contact_dissipated_J").get<double>());
    EXPECT_EQ(facts.at("mbd_contact_dissipated_J"), facts.at("mbd_dissipated_J"));
    EXPECT_EQ(seen["bounce.points"], 0);
    EXPECT_EQ(norm(seen.vector("bounce.force")) + norm(seen.vector("bounce.centre")), 0);
    EXPECT_EQ(facts.at("mbd_contact_depth_of"),
              "shape \"ball\" of body \"ball\" and shape \"floor\" of the ground");
    if (e < 1) continue;
    // Of the ends of 32 steps the deepest is at most half a step from the middle.
    expect_near("largest force", facts.at("mbd_largest_contact_force_N").get<double>(), v * std::sqrt(k * m),
                2e-3 * v * std::sqrt(k * m));
    expect_near("depth over the radius", facts.at("mbd_contact_depth_share").get<double>(),
                v * std::sqrt(m / k) / R, 2e-3 * v * std::sqrt(m / k) / R);
    expect_near("its instant", facts.at("mbd_contact_depth_at_s").get<double>(),
                0.01 / v + std::numbers::pi / 2 * std::sqrt(m / k), 5e-5);
  }
}

// Two balls beside each other, one of them on a third: what each side of an output has.
ContactScene pile() {
  ContactScene s;
  s.add_floor();
  s.add_ball("low", 1, 0.1, {0, 0, 0.1});
  s.add_ball("high", 2, 0.1, {0, 0, 0.3});
  s.add_ball("beside", 4, 0.1, {1, 0, 0.1});
  s.material() = {"stuff", 1e5, 0, 0, 0.1, 0.5};
  const ContactSide low{{0}, ""}, high{{1}, ""}, beside{{2}, "beside"}, floor{ground, ""};
  s.scene.contact->outputs = {{"all", {low, high, beside}, {}},
                              {"floor", {floor}, {}},
                              {"on_low", {low}, {}},
                              {"low_from_floor", {low}, {floor}},
                              {"low_from_high", {low}, {high}},
                              {"two_from_floor", {high, low}, {floor}}};
  return s;
}

TEST(ContactOutputs, SidesOfAPile) {
  const ContactScene s = pile();
  ContactRun run(s.scene, 1e-2);
  run.advance(300);
  const Seen seen(s.scene, run);
  const auto expect = [&](const std::string& output, double force, double normal, double points) {
    expect_near(output + ".force.z", seen[output + ".force.z"], force, 1e-6);
    expect_near(output + ".normal_force", seen[output + ".normal_force"], normal, 1e-6);
    EXPECT_EQ(seen[output + ".points"], points) << output;
  };
  expect("all", 7 * g, 7 * g, 2);
  expect("floor", -7 * g, 7 * g, 2);
  expect("on_low", g, 5 * g, 2);
  expect("low_from_floor", 3 * g, 3 * g, 1);
  expect("low_from_high", -2 * g, 2 * g, 1);
  expect("two_from_floor", 3 * g, 3 * g, 1);
  expect_near("centre of all", seen["all.centre.x"], 4. / 7, 1e-6);
  expect_near("energy in the contact", seen["low_from_high.stored_energy"], 0.5 * 4 * g * g / 1e5, 1e-9);
}

// Outputs that share no contact and have all of them account for all that is dissipated.
TEST(ContactOutputs, LossesAddUp) {
  ContactScene s = pile();
  s.body({0}).twist.v_WB = {0.5, 0, 0};
  s.body({1}).twist.v_WB = {-0.5, 0.1, -1};
  ContactRun run(s.scene, 1e-2);
  run.advance(100);
  const Seen seen(s.scene, run);
  const double all = run.facts().at("mbd_contact_dissipated_J").get<double>();
  EXPECT_GT(all, 0.1);
  expect_near("floor and low_from_high", seen["floor.loss_energy"] + seen["low_from_high.loss_energy"], all,
              1e-12);
}

// Outputs change no bit of the motion, and those after a rollback are the same.
TEST(ContactOutputs, LeaveTheMotionAsItIs) {
  const auto end = [](bool outputs, bool rollback) {
    ContactScene s = pile();
    s.body({1}).twist = {{0.1, 0, 0}, {0, 3, 1}};
    if (!outputs) s.scene.contact->outputs.clear();
    ContactRun run(s.scene, 1e-2);
    run.advance(10);
    if (rollback) {
      run.solver.save();
      run.advance(7);
      run.done -= 7;
      run.solver.restore();
    }
    run.advance(20);
    const nlohmann::json facts = run.facts();
    return std::pair{facts.at("mbd_state_hash").get<std::string>(), run.solver.observe().elements};
  };
  EXPECT_EQ(end(true, false).first, end(false, false).first);
  EXPECT_TRUE(end(false, false).second.empty());
  EXPECT_EQ(end(true, false), end(true, true));
}

// Forces, torques and centres move with the scene.
TEST(ContactOutputs, MoveWithTheScene) {
  ContactScene s;
  s.add_floor();
  const BodyId box = s.add_box("box", 1, {0.2, 0.3, 0.1}, {0, 0, 0.051});
  s.body(box).twist = {{1, 0.4, 0}, {0, 0, 2}};
  s.material() = {"stuff", 1e5, 0, 0, 0.4, 0.3};
  s.scene.contact->outputs = {{"feet", {{box, ""}}, {{ground, "floor"}}}};
  const auto end = [&](const scene::Scene& scene) {
    ContactRun run(scene, 1e-3);
    run.advance(100);
    return Seen(scene, run);
  };
  const Seen here = end(s.scene);
  EXPECT_GT(norm(here.vector("feet.friction")), 1);
  std::mt19937_64 random(5);
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const test::RigidMotion motion(test::random_rotation(random), {0, 0, 0}, {10, -20, 5});
    const Seen there = end(test::moved(s.scene, motion));
    for (const char* channel : {"force", "friction", "torque"})
      worst = std::max(worst, norm(motion.vector_back(there.vector(std::string("feet.") + channel)) -
                                   here.vector(std::string("feet.") + channel)));
    worst =
        std::max(worst, norm(motion.point_back(there.vector("feet.centre")) - here.vector("feet.centre")));
  }
  expect_near("largest deviation in three frames [N], [N m], [m]", worst, 0, 1e-5);
}

}  // namespace
}  // namespace tandem::mbd
