// The heavy top of the notes: m = 15 kg, J = diag(.234375, .46875, .234375) kg m2, 1 m from the tip, started
// with 150 rad/s about its axis; on a ball joint of the tree, and as a free body on a cut ball joint.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/table.hpp"

namespace tandem::mbd {
namespace heavy_top_test {

constexpr double g = 9.81, m = 15, J1 = .234375, J3 = .46875, spin = 150, w0 = -4.61538;

// Everything follows from the position n of the centre of mass, 1 m from the tip: the spin is constant, and
// so are energy and angular momentum about the vertical. They leave open whether the top rises or sinks:
// `rising` = +-1.
struct Exact {
  Vector3d n, v, force;
  Exact(const Vector3d& at, double rising) : n(at) {
    const double J = J1 + m;  // about the tip, across the axis
    const double speed2 = w0 * w0 - 2 * m * g * n.z() / J;
    // L_z = J (n x n')_z + J3 spin n_z; zero at the start, where n = (0, 1, 0), n' = (-w0, 0, 0): (n x n')_z
    // = w0.
    const double turn = w0 - J3 * spin * n.z() / J;
    const double ring = 1 - n.z() * n.z();
    const double vz = rising * std::sqrt(std::max(0.0, speed2 * ring - turn * turn));
    // Across the meridian: turn / ring (z x n); along it: vz.
    v = turn / ring * Vector3d(-n.y(), n.x(), 0) + vz / ring * (Vector3d::UnitZ() - n.z() * n);
    // J n x n'' + J3 spin n' = n x (-m g z), and n . n'' = -n'^2.
    const Vector3d across = (n.cross(Vector3d(0, 0, -m * g)) - J3 * spin * v) / J;
    const Vector3d a = -v.squaredNorm() * n - n.cross(across);
    force = m * (a + Vector3d(0, 0, g));
  }
};

// The scene has no field for the rates of a ball joint in the tree.
struct Top : machines::Run {
  Top(bool cut, double h, Constraints form)
      : Run(cut ? machines::shipped("heavy_top") : machines::heavy_top(), h, 0.9, {1e-13, 30}, form) {
    if (!cut) restart([](State& s) { s.u = Vector3d(0, spin, w0); });
  }
};

std::vector<double> errors(machines::Run& run, const Vector3d& exact) {
  const Exact e(exact, run.velocity(0).z() > 0 ? 1 : -1);
  EXPECT_NEAR(run.state.q.tail<4>().norm(), 1, 1e-14);
  return {(run.position(0) - e.n).norm(), (run.velocity(0) - e.v).norm(),
          (to_eigen(run.joint("tip").reaction.force) - e.force).norm()};
}

void converges(bool cut, Constraints form, double t, const Vector3d& exact, int first, int halvings) {
  const std::string how =
      cut ? (form == Constraints::index2 ? "cut, index 2" : "cut, index 3") : "in the tree";
  OrderTable table("heavy top, tip " + how + ", t = " + std::to_string(t) + " s, rho_inf = 0.9",
                   {"position [m]", "velocity [m/s]", cut ? "multipliers [N]" : "reaction [N]"});
  for (int k = 0; k <= halvings; ++k) {
    const int steps = first << k;
    Top run(cut, t / steps, form);
    run.advance(steps);
    table.add(t / steps, errors(run, exact));
  }
  table.expect_order(2.0, 0.1);
}

const Vector3d after_200ms(0.6055505613772, 0.5989576817948, -0.5239830274301);
const Vector3d after_1s(0.1733439640987, 0.6400885920705, -0.7484907911336);

TEST(HeavyTop, ConvergesInTheTree) {
  converges(false, Constraints::index2, .2, after_200ms, 400, 3);
  converges(false, Constraints::index2, 1, after_1s, 4000, 3);
}

TEST(HeavyTop, ConvergesOnACutJoint) {
  converges(true, Constraints::index2, .2, after_200ms, 400, 3);
  converges(true, Constraints::index3, .2, after_200ms, 400, 3);
}

TEST(HeavyTop, ReachesTheExactPositionAtASmallStep) {
  for (const bool cut : {false, true}) {
    const int steps = cut ? 49152 : 393216;
    Top run(cut, .2 / steps, Constraints::index2);
    const double cpu = run.advance_timed(steps);
    expect_within(std::string("heavy top ") + (cut ? "on a cut joint" : "in the tree") + ", t = 0.2 s, " +
                      std::to_string(steps) + " steps",
                  errors(run, after_200ms)[0], 1e-8, "m", cpu);
  }
}

}  // namespace heavy_top_test
}  // namespace tandem::mbd
