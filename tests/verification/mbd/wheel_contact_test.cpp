// Cylinders as wheels: on planes, steps, bumps and meshes, against closed forms.
#include <cmath>
#include <numbers>

#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/mesh_scenes.hpp"

namespace tandem::mbd::contacts {
namespace {

// About the y axis.
BodyId add_wheel(MeshScene& s, double mass, double radius, double width, Vec3d position, double lean = 0) {
  const double J = mass * radius * radius / 2, across = mass * (3 * radius * radius + width * width) / 12;
  const BodyId wheel =
      s.add("wheel", mass, {across, across, J}, position, scene::CylinderShape{radius, width, {}, {}});
  s.body(wheel).pose.q_WB = exp(Vec3d{lean, 0, 0}) * exp(Vec3d{std::numbers::pi / 2, 0, 0});
  return wheel;
}

// A wheel of radius z on a vertical slide that moves along x at the given speed.
void draw_wheel(MeshScene& s, double width, Vec3d position, double speed) {
  const BodyId cart = machines::add_body(s.scene, "cart", 1, {1, 1, 1}, position),
               hub = machines::add_body(s.scene, "hub", 1, {1, 1, 1}, position),
               wheel = add_wheel(s, 20, position.z, width, position);
  machines::add_joint(s.scene, "pull", scene::JointType::prismatic, ground, cart, position, {1, 0, 0})
      .motion = scene::ConstantMotion{0, speed};
  machines::add_joint(s.scene, "slide", scene::JointType::prismatic, cart, hub, position, {0, 0, 1});
  machines::add_joint(s.scene, "axle", scene::JointType::revolute, hub, wheel, position, {0, 1, 0});
}

// A solid cylinder rolls down a slope at 2/3 of the acceleration of one that slides, and its two ends bear
// half of the weight each.
TEST(WheelContact, RollsDownASlope) {
  const double R = 0.3, k = 1e6, m = 20, angle = 0.2;
  MeshScene s({g * std::sin(angle), 0, -g * std::cos(angle)});
  s.add_floor();
  add_wheel(s, m, R, 0.2, {0, 0, R});
  s.material() = {"stuff", k, 0, 0, 0.1, 0.5};
  ContactRun run = s.run(1e-2);
  run.advance(50);
  const double v = run.velocity().x;
  run.advance(100);
  const double a = g * std::sin(angle) / 1.5;
  expect_near("acceleration [m/s2]", run.velocity().x - v, a, 1e-3 * a);
  expect_near("spin [rad/s]", run.spin().y, run.velocity().x / R, 1e-3 * run.velocity().x / R);
  expect_near("depth [m]", R - run.position().z, m * g * std::cos(angle) / (2 * k), 1e-7);
  expect_energy(run, 1e-9);
}

// One that leans touches with one rim: its centre is R cos(lean) + w/2 sin(lean) high when it does.
TEST(WheelContact, ALeaningWheelTouchesWithOneRim) {
  const double R = 0.3, width = 0.2, lean = 0.4, lowest = R * std::cos(lean) + width / 2 * std::sin(lean);
  MeshScene s;
  s.add_floor();
  add_wheel(s, 20, R, width, {0, 0, lowest + g / 2 * 0.01}, lean);
  s.material() = {"stuff", 1e6, 0, 0, 0.1, 0};
  ContactRun run = s.run(1e-3);
  int touched = 0;
  double at = 0;
  for (int i = 0; i < 130 && !touched; ++i) {
    run.advance(1);
    touched = static_cast<int>(run.facts().at("mbd_body_contacts").get<double>());
    at = static_cast<double>(i + 1) * 1e-3;
  }
  EXPECT_EQ(touched, 1);
  expect_near("time of the touch [s]", at, 0.1, 1.01e-3);
}

// The wheel is drawn slowly over a step: its axle is R from the road, then R from the edge, then R from the
// step. The step is a box or a mesh.
TEST(WheelContact, TheAxleGoesAroundTheEdgeOfAStep) {
  const double R = 0.3, step = 0.06, k = 1e8, v = 0.1;
  for (const int kind : {0, 1}) {
    MeshScene s;
    s.add_floor();
    if (kind == 0) {
      s.add_ground("kerb", scene::BoxShape{{2, 2, 2 * step}, {}}).pose.p_WB = {1, 0, 0};
    } else {
      TriangleMesh kerb = box_mesh({2, 2, 2 * step});
      for (Vec3d& p : kerb.vertices) p = p + Vec3d{1, 0, 0};
      s.add_ground_mesh("kerb", kerb);
    }
    draw_wheel(s, 0.2, {-0.4, 0, R}, v);
    s.material() = {"stuff", k, 0, 0, 0.05, 0.8};
    ContactRun run = s.run(5e-3);
    double worst = 0, deepest = 0;
    for (int i = 0; i < 1200; ++i) {
      run.advance(1);
      const Vec3d p = run.position(2);
      const double begin = -std::sqrt(R * R - (R - step) * (R - step));
      const double z = p.x < begin ? R : p.x < 0 ? step + std::sqrt(R * R - p.x * p.x) : R + step;
      worst = std::max(worst, std::abs(p.z - z)), deepest = std::max(deepest, z - p.z);
    }
    std::printf("  x %.4f, %s steps, deepest %.2e m\n", run.position(2).x,
                run.facts().at("mbd_steps").dump().c_str(), deepest);
    EXPECT_GT(run.position(2).x, 0.15);
    expect_near(
        kind == 0 ? "box: largest deviation of the axle [m]" : "mesh: largest deviation of the axle [m]",
        worst, 0, 5e-5);
  }
}

// A wheel that stands before a step climbs it by a torque of its load times the lever of its centre about the
// edge: T = W sqrt(2 R h - h^2). The work of the torque is in the motion, the height and the loss.
TEST(WheelContact, TheTorqueThatClimbsAStep) {
  const double R = 0.3, step = 0.05, m = 60, T = (m + 1) * g * std::sqrt(2 * R * step - step * step);
  double lifted[2] = {};
  for (const int drives : {0, 1}) {
    MeshScene s;
    s.add_floor();
    s.add_ground("kerb", scene::BoxShape{{4, 2, 2 * step}, {}}).pose.p_WB = {2, 0, 0};
    const Vec3d at{-std::sqrt(2 * R * step - step * step) - 1e-4, 0, R};
    const BodyId cart = machines::add_body(s.scene, "cart", 1, {1, 1, 1}, at),
                 hub = machines::add_body(s.scene, "hub", 1, {1, 1, 1}, at),
                 wheel = add_wheel(s, m, R, 0.2, at);
    machines::add_joint(s.scene, "way", scene::JointType::prismatic, ground, cart, at, {1, 0, 0});
    machines::add_joint(s.scene, "slide", scene::JointType::prismatic, cart, hub, at, {0, 0, 1});
    machines::add_joint(s.scene, "axle", scene::JointType::revolute, hub, wheel, at, {0, 1, 0});
    // Slowly to its value: the wheel comes to the step first.
    scene::Actuator motor;
    motor.name = "motor", motor.joint = {2};
    motor.size = scene::RampMotion{.to = (drives ? 1.02 : 0.98) * T, .duration = 4};
    s.scene.mbd->forces.push_back(motor);
    s.material() = {"stuff", 1e8, 0, 0, 0.05, 1.2};
    ContactRun run = s.run(5e-3);
    for (int i = 0; i < 1000 && lifted[drives] < 0.99 * step; ++i) {
      run.advance(1);
      lifted[drives] = run.position(2).z - R;
    }
    const double balance = run.facts().at("mbd_largest_energy_balance_J").get<double>();
    expect_near(drives ? "energy balance of the climb [J]" : "energy balance before the step [J]", balance, 0,
                1e-2 * m * g * step);
  }
  expect_near("0.98 of the torque lifts the wheel by [m]", lifted[0], 0, 1e-3 * step);
  expect_near("1.02 of it lifts it by [m]", lifted[1], step, 0.02 * step);
}

// Over a bump of a height field the axle follows the highest circle about a point of the profile.
TEST(WheelContact, RollsOverABumpOfAHeightField) {
  const double R = 0.3, k = 1e7, v = 0.3;
  const auto bump = [](double x, double) {
    return std::abs(x) < 0.4 ? 0.03 * (1 + std::cos(x * std::numbers::pi / 0.4)) : 0.;
  };
  MeshScene s;
  const int n = 120;
  s.add_ground("road", field(2.4, 1, n, 10, bump));
  draw_wheel(s, 0.25, {-0.7, 0.013, R}, v);
  s.material() = {"stuff", k, 0, 0, 0.05, 0.8};
  ContactRun run = s.run(5e-3);
  double worst = 0;
  const int windows = static_cast<int>(1.4 / v / 5e-3);
  for (int i = 0; i < windows; ++i) {
    run.advance(1);
    const Vec3d p = run.position(2);
    double highest = -1;  // over the polygon of the heights
    for (int j = 0; j <= 20 * n; ++j) {
      const double x = 2.4 * (j / (20. * n) - .5), cell = std::floor(j / 20.), part = j / 20. - cell,
                   x0 = 2.4 * (cell / n - .5);
      if (std::abs(x - p.x) > R) continue;
      const double z = (1 - part) * bump(x0, 0) + part * bump(x0 + 2.4 / n, 0);
      highest = std::max(highest, z + std::sqrt(R * R - (x - p.x) * (x - p.x)));
    }
    worst = std::max(worst, std::abs(p.z - highest));
  }
  std::printf("  x %.4f, %s steps, %s contacts\n", run.position(2).x,
              run.facts().at("mbd_steps").dump().c_str(), run.facts().at("mbd_body_contacts").dump().c_str());
  expect_near("largest deviation of the axle [m]", worst, 0, 2e-4);
}

TEST(WheelContact, ATriangulatedPlaneIsAPlane) {
  const auto motion = [&](bool mesh) {
    MeshScene s;
    if (mesh)
      s.add_ground_mesh("floor", irregular_plane(8, 80));
    else
      s.add_floor();
    const BodyId wheel = add_wheel(s, 2, 0.2, 0.1, {0.013, 0.021, 0.25}, 0.2);
    s.body(wheel).twist = {{1, 0, 0}, {0, 3, 0.5}};
    s.material() = {"stuff", 1e5, 0, 0, 0.3, 0.4};
    std::mt19937_64 random(3);
    const test::RigidMotion turned(test::random_rotation(random), {0, 0, 0}, {1, 2, 3});
    ContactRun run(test::moved(s.scene, turned), 1e-3, s.meshes);
    std::vector<Vec3d> path;
    for (int i = 0; i < 8; ++i) run.advance(50), path.push_back(run.position());
    return path;
  };
  const std::vector<Vec3d> on_plane = motion(false), on_mesh = motion(true);
  double worst = 0;
  for (std::size_t i = 0; i < on_plane.size(); ++i) worst = std::max(worst, norm(on_plane[i] - on_mesh[i]));
  expect_near("largest deviation [m]", worst, 0, 1e-8);
}

TEST(WheelContact, OneThatLiesOnItsEndIsRefused) {
  MeshScene s;
  s.add_floor();
  s.add("drum", 1, {0.1, 0.1, 0.1}, {0, 0, 0.2}, scene::CylinderShape{0.2, 0.3, {}, {}});
  EXPECT_NE(refusal_of(s, 10).find("flat end"), std::string::npos) << refusal_of(s, 10);
}

}  // namespace
}  // namespace tandem::mbd::contacts
