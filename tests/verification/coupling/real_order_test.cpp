// Order in the window H of the real solvers: a sphere that lies on a plate on a spring, a two-mass oscillator
// with the contact of Hertz and Tsuji between the masses. The plate starts off its place of rest, and the
// sphere stays on it. The runs of all windows take the same micro steps, so that what differs is the
// coupling; the finest one is held against an integration of the equations of motion that shares no code with
// the solvers.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/verification/coupling/real_run.hpp"

namespace tandem::test {
namespace real_order_test {

constexpr double radius = 0.05, density = 2500, young = 2e7, poisson = 0.25, restitution = 0.5;
constexpr double plate_mass = 2, spring = 2e4, gravity = 9.81;                 // [kg] [N/m] [m/s2]
constexpr double start_overlap = 2e-4, end_time = 0.04, micro_step = 1.25e-6;  // [m] [s] [s]
const double sphere_mass = 4.0 / 3 * std::numbers::pi * density * std::pow(radius, 3);
// The spring carries a third more than both weights at the start.
const double stretch = 1.3 * (plate_mass + sphere_mass) * gravity / spring;  // [m]

std::string scene_text(const std::string& coupling) {
  return fmt::format(
      R"({{"tandem": "1.0", "name": "sphere_on_plate", "gravity": [0, 0, {}], "end_time": {},
  "coupling": {{{}}},
  "mbd": {{"bodies": [{{"name": "plate", "mass": {}, "inertia": [0.1, 0.1, 0.1], "position": [0, 0, 0]}}],
    "joints": [{{"name": "slide", "type": "prismatic", "parent": "ground", "child": "plate", "position": [0, 0, 0],
                 "axis": [0, 0, 1]}}],
    "forces": [{{"name": "spring", "type": "spring_damper", "body_a": "ground", "body_b": "plate",
                 "point_a": [0, 0, 1], "point_b": [0, 0, 0], "stiffness": {}, "damping": 0, "length": {:.17g}}}]}},
  "dem": {{"precision": "double", "micro_step": {}, "contact": "hertz_mindlin",
    "materials": [{{"name": "glass", "density": {}, "young": {}, "poisson": {}}}],
    "pairs": [{{"a": "glass", "b": "glass", "restitution": {}, "friction": 0.3}}],
    "particles": [{{"name": "ball", "material": "glass", "radius": {},
      "fill": {{"type": "lattice", "min": [-0.05, -0.05, {:.17g}], "max": [0.051, 0.051, 0.2], "spacing": 0.2,
               "count": 1}}}}],
    "walls": [{{"name": "top", "body": "plate", "material": "glass",
               "shape": {{"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}}}],
    "domain": {{"min": [-1, -1, -1], "max": [1, 1, 1]}}}}}})",
      -gravity, end_time, coupling, plate_mass, spring, 1 - stretch, micro_step, density, young, poisson,
      restitution, radius, -start_overlap);
}

// Height and velocity of plate and sphere.
using Motion = std::array<double, 4>;

// The same by the classical Runge-Kutta method.
Motion integrate(double z_sphere) {
  const double e_star = young / (2 * (1 - poisson * poisson)), k = 4.0 / 3 * e_star * std::sqrt(radius);
  const double l = std::log(restitution), pi = std::numbers::pi;
  const double c = -std::sqrt(5.0) * l / std::sqrt(l * l + pi * pi) * std::sqrt(sphere_mass * k);
  const auto rate = [&](const Motion& s) {
    const double overlap = radius - (s[2] - s[0]), u = s[3] - s[1];
    const double F = overlap > 0 ? k * std::pow(overlap, 1.5) - c * std::pow(overlap, 0.25) * u : 0;
    return Motion{s[1], (spring * (stretch - s[0]) - F) / plate_mass - gravity, s[3],
                  F / sphere_mass - gravity};
  };
  const auto plus = [](Motion a, double h, const Motion& b) {
    for (std::size_t i = 0; i < 4; ++i) a[i] += h * b[i];
    return a;
  };
  Motion s{0, 0, z_sphere, 0};
  const int steps = 40000;
  const double h = end_time / steps;
  for (int i = 0; i < steps; ++i) {
    const Motion k1 = rate(s), k2 = rate(plus(s, h / 2, k1)), k3 = rate(plus(s, h / 2, k2)),
                 k4 = rate(plus(s, h, k3));
    for (std::size_t j = 0; j < 4; ++j) s[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
  }
  return s;
}

struct Result {
  Motion motion{};
  double created = 0;  // energy, by the coupling [J]
  double closure = 0;  // of the impulse [-]
};

Result run(const std::string& coupling, double window) {
  RealRun pair(scene_text(fmt::format("{}, \"window\": {}", coupling, window)));
  pair.run(end_time);
  const protocol::BodyState plate = pair.body(0);
  const launch::Accounts& accounts = pair.coupler().accounts();
  return {{plate.pose.p_WB.z, plate.twist.v_WB.z, pair.position(0, 2), pair.velocity(0, 2)},
          accounts.energy_created(),
          accounts.impulse_closure()};
}

// Of positions and velocities, in metres at the contact's own frequency.
double distance(const Motion& a, const Motion& b) {
  const double scale = 300;  // [rad/s]
  return std::hypot(std::hypot(a[0] - b[0], (a[1] - b[1]) / scale),
                    std::hypot(a[2] - b[2], (a[3] - b[3]) / scale));
}

const char* const second_order = R"("scheme": "dem_first", "load": "linear", "path": "quadratic")";

const Result& reference() {
  static const Result result = run(second_order, 8 * micro_step);
  return result;
}

TEST(RealOrder, ReferenceAgreesWithTheEquationsOfMotion) {
  const double start = radius - start_overlap;
  const double error = distance(reference().motion, integrate(start)),
               moved = distance(reference().motion, {0, 0, start, 0});
  std::printf(
      "  both solvers against Runge-Kutta: %.3e m of %.3e m moved; tolerance: the micro step's 1e-3\n", error,
      moved);
  EXPECT_LT(error, 1e-3 * moved);
}

struct Case {
  const char* name;
  const char* coupling;
  double order;
  double energy_order;  // of the energy created; 0: it changes its sign, or is that of the micro step
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class RealOrder : public testing::TestWithParam<Case> {};

TEST_P(RealOrder, InTheWindow) {
  const Case& c = GetParam();
  Result coarse = run(c.coupling, 1e-3);
  for (const double window : {5e-4, 2.5e-4, 1.25e-4, 6.25e-5}) {
    const Result fine = run(c.coupling, window);
    const Result& best = reference();
    const double coarse_error = distance(coarse.motion, best.motion),
                 error = distance(fine.motion, best.motion);
    // In the coarsest pair the next term of the error still shows (1.11 for dem_first): for information.
    const bool asymptotic = window < 4e-4;
    const double order = std::log2(coarse_error / error),
                 energy = std::log2(std::abs(coarse.created / fine.created));
    std::printf(
        "  %-22s window %.4g ms: error %.3e m, order: expected %.1f  measured %.3f  tolerance %s;  energy "
        "created %.2e J, order %.2f;  impulse closure %.1e\n",
        c.name, 1e3 * window, error, c.order, order, asymptotic ? "0.1" : "none (coarse)", fine.created,
        energy, fine.closure);
    EXPECT_LT(fine.closure, 1e-13);
    if (asymptotic) {
      EXPECT_NEAR(order, c.order, 0.1);
      if (c.energy_order > 0) {
        EXPECT_GT(energy, c.energy_order - 0.2);
      }
    }
    coarse = fine;
  }
}

INSTANTIATE_TEST_SUITE_P(SphereOnPlate, RealOrder,
                         testing::Values(Case{"parallel", R"("scheme": "parallel")", 1, 0},
                                         Case{"mbd_first", R"("scheme": "mbd_first")", 1, 0},
                                         Case{"dem_first", R"("scheme": "dem_first")", 1, 2},
                                         Case{"dem_first_second_order", second_order, 2, 0}),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

}  // namespace real_order_test
}  // namespace tandem::test
