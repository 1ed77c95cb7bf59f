// Contacts between bodies against closed forms: friction with Hertz, and stiff contacts at rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd {
namespace {

using namespace contacts;

// A table of 300 kg on three balls of radius 0.1 m, a distance above the floor, that a force pushes along x
// from 0.5 s to 1 s up to a fifth of its weight. Friction holds it: each foot gives way by T / k_t, with
// Mindlin's k_t = 2 (1 - nu) / (2 - nu) dN/dd at the depth under its weight.
TEST(ContactLaw, HertzFeetStickByMindlinsStiffness) {
  constexpr double mass = 300, young = 1e8, nu = 0.3, radius = 0.1;
  for (const double above : {0., 1e-3}) {
    ContactScene s;
    s.add_floor();
    s.material() = {"stuff", {}, young, nu, 0.1, 0.6};
    const BodyId table =
        s.add("table", mass, {10, 10, 10}, {0, 0, radius + above}, scene::SphereShape{radius});
    s.scene.shapes.clear();
    for (int i = 0; i < 3; ++i) {
      scene::Shape foot;
      foot.name = "foot" + std::to_string(i);
      foot.use = scene::ShapeUse::contact;
      foot.body = table;
      foot.contact_material = 0;
      foot.is_of_body = true;
      foot.geometry = scene::SphereShape{radius};
      const double angle = 2 * std::numbers::pi / 3 * i;
      foot.pose.p_WB = {0.5 * std::cos(angle), 0.5 * std::sin(angle), 0};
      s.scene.shapes.push_back(foot);
    }
    const double push = 0.2 * mass * g;
    scene::BodyLoad load;
    load.name = "push", load.kind = scene::BodyLoad::Kind::force, load.body = table;
    load.direction = {1, 0, 0};
    load.size = scene::RampMotion{0, push, 0.5, 0.5};
    s.scene.mbd->forces.push_back(load);
    ContactRun run(s.scene, 0.005);
    run.advance(100);
    const double before = run.position().x;
    run.advance(300);
    const double N = mass * g / 3, k = 4. / 3 * young / (2 * (1 - nu * nu)) * std::sqrt(radius),
                 depth = std::pow(N / k, 2. / 3), k_t = 2 * (1 - nu) / (2 - nu) * 1.5 * k * std::sqrt(depth),
                 shift = push / 3 / k_t;
    expect_near("feet start " + std::to_string(above) + " m above the floor: depth",
                radius - run.position().z, depth, 1e-4 * depth);
    expect_near("shift", run.position().x - before, shift, 0.01 * shift);
  }
}

// A ball falls 10 mm on a stiff floor and comes to rest there, while a heavy pendulum of 20 m swings. The
// depth under its weight is 1e-8 m and less: a part of 1e-10 of the size of this machine and of Newton's
// tolerance.
TEST(ContactLaw, StiffContactComesToRestBesideAHeavyPendulum) {
  for (const auto& [stiffness, step] : {std::pair{1e9, 1e-3}, {1e10, 5e-3}, {1e11, 1e-3}}) {
    ContactScene s;
    s.add_floor();
    s.add_ball("ball", 1, 0.1, {0, 0, 0.11});
    s.material() = {"stuff", stiffness, 0, 0, 0.3, 0.5};
    const BodyId pendulum = machines::add_body(s.scene, "pendulum", 1000, {100, 100, 100}, {20, 0, 20});
    machines::add_joint(s.scene, "pivot", scene::JointType::revolute, ground, pendulum, {10, 0, 30}).axis = {
        0, 1, 0};
    ContactRun run(s.scene, step);
    run.advance(static_cast<int>(1 / step));
    double highest = -1, lowest = 1;
    for (int i = 0; i < static_cast<int>(2 / step); ++i) {
      run.advance(1);
      const double depth = 0.1 - run.position().z;
      highest = std::max(highest, depth), lowest = std::min(lowest, depth);
    }
    const double depth = g / stiffness;
    expect_near("least depth at rest, stiffness " + std::to_string(stiffness), lowest, depth, 0.01 * depth);
    expect_near("largest depth at rest", highest, depth, 0.01 * depth);
  }
}

// A ball falls 0.1 m on a stiff floor in windows that are many times as long as its impacts: it rises no
// higher than its restitution tells, loses what it had, and rests, without bouncing within the windows.
TEST(ContactLaw, StiffContactInLongWindowsThrowsNothing) {
  for (const double restitution : {0.3, 0.5})
    for (const double stiffness : {1e9, 1e10, 1e11})
      for (const double window : {1e-2, 5e-3, 1e-3}) {
        ContactScene s;
        s.add_floor();
        s.material() = {"stuff", stiffness, 0, 0, restitution, 0.5};
        s.add_ball("ball", 1, 0.1, {0, 0, 0.2});
        ContactRun run(s.scene, window);
        run.advance(static_cast<int>(std::lround(0.2 / window)));
        double highest = 0;
        for (int i = 0; i < static_cast<int>(std::lround(1.8 / window)); ++i) {
          run.advance(1);
          highest = std::max(highest, run.position().z - 0.1);
        }
        char what[120];
        std::snprintf(what, sizeof what, "restitution %g, stiffness %.0e N/m, windows of %g s: ", restitution,
                      stiffness, window);
        EXPECT_LT(highest, 0.1 * restitution * restitution * 1.02) << what;
        const nlohmann::json facts = run.facts();
        expect_near(std::string(what) + "energy dissipated [J]",
                    facts.at("mbd_contact_dissipated_J").get<double>(), 0.1 * g, 0.01 * 0.1 * g);
        expect_near("depth at rest", 0.1 - run.position().z, g / stiffness, 0.01 * g / stiffness);
        run.advance(10);
        expect_near("steps of ten windows at rest",
                    run.facts().at("mbd_steps").get<double>() - facts.at("mbd_steps").get<double>(), 10, 0);
      }
}

}  // namespace
}  // namespace tandem::mbd
