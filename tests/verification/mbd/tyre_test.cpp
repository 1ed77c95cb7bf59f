// The brush tyre against its closed forms, and vehicles on four of them against the bicycle model.
#include <random>

#include "mbd_server/spatial/spatial.hpp"
#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/tyre_machines.hpp"

namespace tandem::mbd::tyres {
namespace {

// [Pacejka2012], equations 3.11 and 3.13, with slips along and across.
struct Closed {
  double x, y, aligning;
};
Closed brush(const TyreData& t, double load, double sx, double sy) {
  const double cx = t.slip * sx, cy = t.cornering * sy, c = std::hypot(cx, cy), psi = c / (3 * t.friction);
  const double force =
      psi < 1 ? t.friction * load * (3 * psi - 3 * psi * psi + psi * psi * psi) : t.friction * load;
  const double trail = psi < 1 ? t.patch / 6 * std::pow(1 - psi, 3) / (1 - psi + psi * psi / 3) : 0;
  return {force * cx / c, force * cy / c, -force * cy / c * trail};
}

TEST(Tyre, CurveAgainstClosedForm) {
  Rig rig;
  std::printf("  %8s %8s | %10s %10s | %10s %10s | %10s %10s   tolerance 5e-3\n", "slip", "tan", "F_x [N]",
              "closed", "F_y [N]", "closed", "M_z [N m]", "closed");
  double worst = 0;
  const auto compare = [&](double s, double yaw) {
    rig.yaw = yaw;
    TyreRun run(rig.scene(s));
    run.advance(1);
    // The slip across is the sliding over the rolling speed.
    const double across = std::tan(yaw) * (1 - s);
    const Closed expected = brush(rig.tyre, rig.load(), s, across);
    const double x = run["tyre.force.x"], y = run["tyre.force.y"], m = run["tyre.aligning_torque"];
    std::printf("  %8.3f %8.3f | %10.2f %10.2f | %10.2f %10.2f | %10.4f %10.4f\n", s, across, x, expected.x,
                y, expected.y, m, expected.aligning);
    const auto check = [&](double measured, double closed) {
      if (std::abs(closed) < 1e-9) {
        EXPECT_NEAR(measured, closed, 1e-3);
        return;
      }
      worst = std::max(worst, std::abs(measured / closed - 1));
      EXPECT_NEAR(measured, closed, 5e-3 * std::abs(closed));
    };
    check(x, expected.x), check(y, expected.y), check(m, expected.aligning);
    EXPECT_NEAR(run["tyre.force.z"], rig.load(), 1e-4 * rig.load());
  };
  for (const double s : {-0.5, -0.15, -0.05, -0.01, 0.01, 0.03, 0.1, 0.19, 0.3}) compare(s, 0);
  for (const double yaw : {-0.2, -0.05, 0.005, 0.02, 0.1, 0.2, 0.3}) compare(0, yaw);
  for (const double s : {-0.1, 0.05, 0.15})
    for (const double yaw : {-0.04, 0.1}) compare(s, yaw);
  std::printf("  largest deviation %.1e\n", worst);
}

// A small slip from the start: the force builds up over the way that the wheel rolls.
TEST(Tyre, RelaxationLength) {
  Rig rig;
  rig.yaw = 1e-4;
  for (const double sigmas : {0.5, 1.0, 2.0}) {
    TyreRun run(rig.scene(0));
    const double rolled = sigmas * rig.tyre.relaxation / std::cos(rig.yaw);
    run.advance(std::round(rolled / rig.speed * 1e3) * 1e-3);
    const double way = run.time() * rig.speed * std::cos(rig.yaw);
    expect_share(
        "lateral force after " + std::to_string(way) + " m [N]", run["tyre.force.y"],
        brush(rig.tyre, rig.load(), 0, std::tan(rig.yaw)).y * (1 - std::exp(-way / rig.tyre.relaxation)),
        5e-3);
  }
}

// Constant torques of the brakes: deceleration and axle loads of the rigid vehicle with its rotating wheels.
TEST(Tyre, BrakingVehicle) {
  Vehicle v;
  v.front.stiffness = v.rear.stiffness = 1e6;
  const double front = -500, rear = -200;
  TyreRun run(v.scene(front, rear));
  run.advance(0.8);
  const double v0 = run.seen().bodies[0].twist.v_WB.x;
  run.advance(0.4);
  const double v1 = run.seen().bodies[0].twist.v_WB.x, a = (v0 - v1) / 0.4;
  const double r_f = run["front_left_tyre.loaded_radius"], r_r = run["rear_left_tyre.loaded_radius"];
  // sum of the torques / r = (M + sum of J / r2) a, where the wheels roll with almost constant slip
  const double rolling = v.all() + 2 * v.wheel_inertia * (1 / (r_f * r_f) + 1 / (r_r * r_r));
  expect_share("deceleration [m/s2]", a, -2 * (front / r_f + rear / r_r) / rolling, 5e-3);
  const double h = (v.mass * v.height + 4 * v.wheel_mass * v.front.radius) / v.all() - v.all() * g / 4e6;
  const double cg = (2 * v.wheel_mass * (v.a - v.b)) / v.all();  // ahead of the chassis' centre
  // The wheels take up angular momentum: that changes the axle loads too.
  const double spin = 2 * v.wheel_inertia * a * (1 / r_f + 1 / r_r);
  const double N_f = (v.all() * g * (v.b + cg) + v.all() * a * h + spin) / v.wheelbase();
  expect_share("load of the front axle [N]", 2 * run["front_left_tyre.force.z"], N_f, 5e-3);
  expect_share("load of the rear axle [N]", 2 * run["rear_left_tyre.force.z"], v.all() * g - N_f, 5e-3);
  // Slip of the brush under the force that brakes vehicle and wheel.
  const double N = N_f / 2, F = -(front / r_f + v.wheel_inertia * a / (r_f * r_f)), mu = v.front.friction;
  const double psi = 1 - std::cbrt(1 - F / (mu * N));
  expect_share("slip of the front wheels", run["front_left_tyre.slip"], -3 * mu * psi / v.front.slip, 1e-2);
  EXPECT_LT(std::abs(run.facts()["mbd_largest_energy_balance_J"].get<double>()), 1e-3 * 0.5 * v.all() * 400);
}

// Steady cornering: both axles need the lateral acceleration times their load, and with forces in proportion
// to the load the two wheels of an axle act as one.
TEST(Tyre, CorneringVehicleAgainstBicycleModel) {
  for (const double steer : {0.01, 0.03}) {
    Vehicle v;
    v.front.stiffness = v.rear.stiffness = 1e6;
    v.front.cornering = 10, v.rear.cornering = 14;
    v.front.patch = v.rear.patch = 0;
    v.height = 0.35;
    v.steer = steer;
    TyreRun run(v.scene(0, 0));
    run.advance(3);
    const auto seen = run.seen().bodies[0].twist;
    const double V = std::hypot(seen.v_WB.x, seen.v_WB.y), rate = seen.w_WB.z;
    const auto angle = [](const TyreData& t, double share) {
      return 3 * t.friction / t.cornering * (1 - std::cbrt(1 - share / t.friction));
    };
    // Root of steer = L rate / V + atan(alpha_f) - atan(alpha_r)
    double low = 0, high = 2 * V * steer / v.wheelbase();
    for (int i = 0; i < 100; ++i) {
      const double r = (low + high) / 2, share = r * V / g;
      const double needed = std::atan(v.a * r / V + std::atan(angle(v.front, share)) -
                                      std::atan(angle(v.rear, share)) + v.b * r / V);
      (needed < steer ? low : high) = r;
    }
    expect_share("yaw rate at a steering angle of " + std::to_string(steer) + " [rad/s]", rate, low, 1e-2);
    std::printf("  lateral acceleration %.2f m/s2 at %.2f m/s\n", rate * V, V);
  }
}

// A step of the steering angle: the linear bicycle model with relaxation, integrated with Runge-Kutta steps.
TEST(Tyre, StepSteerAgainstBicycleModel) {
  Vehicle v;
  v.front.stiffness = v.rear.stiffness = 2e6;
  v.front.cornering = 10, v.rear.cornering = 14;
  v.front.patch = v.rear.patch = 0;
  v.front.relaxation = v.rear.relaxation = 0.4;
  v.height = 0.31;
  v.steer = 1e-3;
  TyreRun run(v.scene(0, 0));
  const double m = v.all(), cg = 2 * v.wheel_mass * (v.a - v.b) / m, a = v.a - cg, b = v.b + cg, V = v.speed,
               J = v.inertia + v.mass * cg * cg + 4 * v.wheel_inertia + 2 * v.wheel_mass * (a * a + b * b) +
                   4 * v.wheel_mass * v.track * v.track / 4;
  const double N_f = m * g * b / (a + b), N_r = m * g * a / (a + b);
  using Y = Eigen::Vector4d;  // lateral velocity, yaw rate, slips of the tread
  const auto rates = [&](const Y& y) {
    const double F_f = v.front.cornering * N_f * y[2], F_r = v.rear.cornering * N_r * y[3];
    return Y((F_f + F_r) / m - V * y[1], (a * F_f - b * F_r) / J,
             V / v.front.relaxation * (v.steer - (y[0] + a * y[1]) / V - y[2]),
             V / v.rear.relaxation * (-(y[0] - b * y[1]) / V - y[3]));
  };
  Y y = Y::Zero();
  double worst = 0, largest = 0;
  for (int k = 1; k <= 100; ++k) {
    for (int i = 0; i < 100; ++i) {
      const double h = 1e-4;
      const Y k1 = rates(y), k2 = rates(y + h / 2 * k1), k3 = rates(y + h / 2 * k2), k4 = rates(y + h * k3);
      y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    run.advance(0.01);
    worst = std::max(worst, std::abs(run.seen().bodies[0].twist.w_WB.z - y[1]));
    largest = std::max(largest, std::abs(y[1]));
    if (k % 20 == 0)
      std::printf("  yaw rate at %.1f s: bicycle %.6e measured %.6e rad/s\n", 0.01 * k, y[1],
                  run.seen().bodies[0].twist.w_WB.z);
  }
  std::printf("  largest difference over the largest rate %.2e tolerance 2e-2\n", worst / largest);
  EXPECT_LT(worst, 2e-2 * largest);
}

// The same vehicle on a road in any direction, with its gravity.
TEST(Tyre, AnyFrame) {
  Vehicle v;
  v.steer = 0.02;
  const scene::Scene scene = TyreRun::scene_of(v.scene(-300, 100));
  const auto end = [](const scene::Scene& s) {
    TyreRun run(s);
    run.advance(0.5);
    return run.seen().bodies[0].pose.p_WB;
  };
  const Vec3d here = end(scene);
  std::mt19937_64 random(5);
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const test::RigidMotion motion(test::random_rotation(random), {0, 0, 0}, {30. * i, -2, 1});
    worst = std::max(worst, norm(motion.point_back(end(test::moved(scene, motion))) - here));
  }
  std::printf("  largest deviation in three frames %.1e m of 10 m tolerance 1e-8\n", worst);
  EXPECT_LT(worst, 1e-8);
}

// A wheel that coasts is braked by its rolling resistance.
TEST(Tyre, RollingResistance) {
  Vehicle v;
  v.front.resistance = v.rear.resistance = 0.012;
  v.front.stiffness = v.rear.stiffness = 1e6;
  TyreRun run(v.scene(0, 0));
  run.advance(1);
  const double v0 = run.seen().bodies[0].twist.v_WB.x;
  run.advance(1);
  const double a = v0 - run.seen().bodies[0].twist.v_WB.x, r = run["front_left_tyre.loaded_radius"];
  expect_share("deceleration [m/s2]", a, 0.012 * g * v.all() / (v.all() + 4 * v.wheel_inertia / (r * r)),
               5e-3);
}

// Wheels that do not turn slide with friction times load; at rest on a slope they do not creep.
TEST(Tyre, LockedWheels) {
  Vehicle v;
  v.front.stiffness = v.rear.stiffness = 1e6;
  json scene = v.scene(0, 0);
  for (json& joint : scene["mbd"]["joints"])
    joint["type"] = "fixed", joint.erase("rate"), joint.erase("axis");
  EXPECT_ANY_THROW(TyreRun{scene});  // the joint of a tyre is revolute
  scene = v.scene(0, 0);
  for (json& joint : scene["mbd"]["joints"]) {
    joint.erase("rate");
    joint["friction"] = {{"force", 1e5}, {"breakaway", 1e5}};
  }
  TyreRun sliding(scene);
  sliding.advance(0.5);
  const double v0 = sliding.seen().bodies[0].twist.v_WB.x;
  sliding.advance(0.5);
  expect_share("deceleration [m/s2]", (v0 - sliding.seen().bodies[0].twist.v_WB.x) / 0.5,
               v.front.friction * g, 5e-3);

  const double slope = 0.3;
  scene["gravity"] = {-g * std::sin(slope), 0, -g * std::cos(slope)};
  scene["mbd"]["bodies"][0]["velocity"] = {0, 0, 0};
  TyreRun parked(scene);
  parked.advance(6);
  const double x0 = parked.seen().bodies[0].pose.p_WB.x;
  parked.advance(10);
  const double creep = parked.seen().bodies[0].pose.p_WB.x - x0;
  std::printf("  creep on the slope in 10 s %.1e m tolerance 1e-9\n", creep);
  EXPECT_NEAR(creep, 0, 1e-9);
}

}  // namespace
}  // namespace tandem::mbd::tyres
