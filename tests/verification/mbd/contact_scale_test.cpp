// Contacts do not depend on the units of length, and a ball that rolls and spins loses nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd {
namespace {

using namespace contacts;

// A ball that is thrown on the floor, bounces, slides and rolls, with all lengths times `scale`.
ContactRun thrown_ball(double scale) {
  ContactScene s({0, 0, -g * scale});
  s.add_floor();
  s.material() = {"stuff", 1e6, 0, 0, 0.4, 0.3};
  const BodyId ball = s.add_ball("ball", 1, scale, {0, 0, 1.5 * scale});
  s.body(ball).twist = {{scale, 0, 0}, {2, 0, 3}};
  return ContactRun(s.scene, 0.01);
}

TEST(ContactScale, BallOfAMillimetreMovesAsOneOfAMetre) {
  constexpr double ratio = 1024;
  ContactRun small = thrown_ball(1. / ratio), large = thrown_ball(1);
  double worst = 0;
  for (int i = 0; i < 300; ++i) {
    small.advance(1), large.advance(1);
    worst = std::max(worst, norm(ratio * small.position() - large.position()));
  }
  expect_near("radii between the ways of the two, over 3 s", worst, 0, 1e-9);
}

// A ball that rolls along a plane without slip and spins about the normal: its contact does not slide.
TEST(ContactScale, BallThatRollsAndSpinsKeepsItsEnergy) {
  for (const double window : {1e-2, 1e-3})
    for (const double spin : {2., 20., 100.}) {
      ContactScene s;
      s.add_floor();
      s.material() = {"stuff", 1e6, 0, 0, 0.5, 0.5};
      const double r = 0.1, depth = g / 1e6;
      const BodyId ball = s.add_ball("ball", 1, r, {0, 0, r - depth});
      s.body(ball).twist = {{1, 0, 0}, {0, 1 / (r - depth), spin}};
      ContactRun run(s.scene, window);
      run.advance(static_cast<int>(2 / window));
      const std::string what =
          "spin " + std::to_string(spin) + " rad/s, windows of " + std::to_string(window) + " s: ";
      expect_near(what + "way", run.position().x, 2, 1e-3);
      expect_near(what + "aside", run.position().y, 0, 1e-3);
      expect_near(what + "dissipated [J]", run.facts().at("mbd_contact_dissipated_J").get<double>(), 0, 1e-4);
      expect_near(what + "spin", run.spin().z, spin, 1e-3 * spin);
    }
}

// A ball that rolls along a groove of 90 degrees touches it at two points, at which it spins as well.
TEST(ContactScale, BallInAGrooveKeepsItsEnergy) {
  for (const double window : {1e-2, 1e-3}) {
    ContactScene s;
    s.material() = {"stuff", 1e6, 0, 0, 0.5, 0.5};
    for (const double side : {-1., 1.}) {
      scene::Shape plane;
      plane.name = side < 0 ? "left" : "right";
      plane.use = scene::ShapeUse::contact;
      plane.contact_material = 0;
      plane.geometry = scene::PlaneShape{{0, 0, 0}, {side * std::sqrt(0.5), 0, std::sqrt(0.5)}};
      s.scene.contact->ground.push_back(plane);
    }
    const double r = 0.1, depth = g / std::sqrt(2) / 1e6;
    const BodyId ball = s.add_ball("ball", 1, r, {0, 0, std::sqrt(2) * (r - depth)});
    s.body(ball).twist = {{0, 1, 0}, {-std::sqrt(2) / (r - depth), 0, 0}};
    ContactRun run(s.scene, window);
    run.advance(static_cast<int>(5 / window));
    const std::string what = "groove, windows of " + std::to_string(window) + " s: ";
    expect_near(what + "way", run.position().y, 5, 5e-3);
    expect_near(what + "dissipated [J]", run.facts().at("mbd_contact_dissipated_J").get<double>(), 0, 1e-3);
  }
}

}  // namespace
}  // namespace tandem::mbd
