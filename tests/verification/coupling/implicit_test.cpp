// Scheme `implicit` on a light plate in heavy grains: a body on a bed that is up to 10,000 times heavier. A
// plain fixed-point iteration multiplies its error by (omega H)^2 / 4 there, and all explicit schemes
// diverge.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/doubles/coupled_oscillator.hpp"

namespace tandem::test {
namespace implicit_test {

using scene::Acceleration;
using scene::Scheme;

constexpr double H = 0.05;  // [s]
constexpr int windows = 200;

// The bed: 1 kg on a spring, 2 pi rad/s. The plate: lighter by `ratio`, on a contact whose stiffness is that
// of grains 50 times stiffer than the bed's spring.
OscillatorBodyParameters plate(double ratio) {
  return {ratio, 0, 0};
}
OscillatorBedParameters grains() {
  const double c = 4 * M_PI * M_PI;
  return {1, 50 * c, 2, c, 0.5};
}
double omega_H(double ratio) {
  return std::sqrt(grains().contact_stiffness / ratio) * H;
}

scene::Coupling implicit(Acceleration method, double relaxation = 0.1) {
  scene::Coupling how;
  how.scheme = Scheme::implicit;
  how.window = H;
  how.iteration = scene::Iteration{{.length = 1e-9, .relaxation = relaxation, .tolerance = 1e-6}, method};
  return how;
}

struct Course {
  double iterations = 0;  // per window, on average
  int most = 0;
  double y = 0, largest = 0;  // of the bed at the end; of the plate at all times [m]
};

Course run(CoupledOscillator& pair) {
  pair.bed.y = 0.1;
  pair.body.x = 0.1;
  Course course;
  for (int i = 0; i < windows; ++i) {
    pair.advance(H);
    course.largest = std::max(course.largest, std::abs(pair.body.x));
  }
  course.iterations = static_cast<double>(pair.coupler().counters().iterations) / windows;
  course.most = pair.coupler().counters().most_iterations;
  course.y = pair.bed.y;
  return course;
}

TEST(Implicit, LightPlateTakesFewIterations) {
  for (const double ratio : {1.0, 1e-1, 1e-2, 1e-3, 1e-4}) {
    for (const auto& [method, name] :
         {std::pair{Acceleration::iqn_ils, "iqn_ils"}, std::pair{Acceleration::aitken, "aitken"}}) {
      CoupledOscillator pair(plate(ratio), grains(), implicit(method));
      const Course course = run(pair);
      std::printf(
          "  mass ratio %.0e, omega H %6.1f, %-8s %.2f iterations a window (most %d; expected below 8), "
          "largest %.3f m\n",
          ratio, omega_H(ratio), name, course.iterations, course.most, course.largest);
      EXPECT_LT(course.largest, 0.15) << "the plate swings with the bed";
      if (method == Acceleration::iqn_ils) {
        EXPECT_LT(course.iterations, 8);
      }
    }
  }
}

TEST(Implicit, WhereExplicitSchemesDivergeWithAWarning) {
  const double ratio = 1e-4;
  for (const Scheme scheme : {Scheme::parallel, Scheme::mbd_first, Scheme::dem_first}) {
    scene::Coupling how;
    how.scheme = scheme;
    how.window = H;
    CoupledOscillator pair(plate(ratio), grains(), how);
    pair.bed.y = pair.body.x = 0.1;
    pair.body.v = 1e-3;
    int first_warning = -1, diverged = -1;
    for (int i = 0; i < windows && diverged < 0; ++i) {
      pair.advance(H);
      if (first_warning < 0 && !pair.coupler().warnings().empty()) first_warning = i;
      if (std::abs(pair.body.x) > 10) diverged = i;
    }
    ASSERT_FALSE(pair.coupler().warnings().empty());
    const std::string& warning = pair.coupler().warnings()[0];
    std::printf("  %-10s warning in window %d, beyond 10 m in window %d\n    %s\n", launch::name(scheme),
                first_warning, diverged, warning.c_str());
    EXPECT_GE(diverged, 0);
    EXPECT_EQ(first_warning, 0);
    EXPECT_LE(first_warning, diverged);
    EXPECT_NE(warning.find("body 'mass'"), std::string::npos);
  }
}

// Constant relaxation converges where the window is small: |1 - w (1 - g')| < 1.
TEST(Implicit, ConstantRelaxationConvergesForAHeavyBodyOnly) {
  CoupledOscillator heavy(plate(1), grains(), implicit(Acceleration::constant, 0.5));
  const Course course = run(heavy);
  std::printf("  mass ratio 1: %.2f iterations a window (most %d)\n", course.iterations, course.most);
  EXPECT_LT(course.iterations, 50);

  CoupledOscillator light(plate(1e-4), grains(), implicit(Acceleration::constant, 0.5));
  light.bed.y = 0.1;
  try {
    light.advance(H);
    FAIL() << "it converged";
  } catch (const Error& error) {
    std::printf("  mass ratio 1e-4: %s\n", error.what());
    EXPECT_EQ(error.code(), ErrorCode::numerics);
    EXPECT_NE(error.problem().find("the coupling iteration of window 0 did not converge in"),
              std::string::npos);
    EXPECT_NE(error.problem().find("body 'mass'"), std::string::npos);
    EXPECT_NE(error.hint().find("iqn_ils"), std::string::npos);
  }
}

// The last iteration of a window is a plain one along the path that was found: a run whose
// path is prescribed as this one from the start, without any iteration, ends in the same bits.
TEST(Implicit, AnIteratedWindowIsThePlainOneAlongItsPath) {
  CoupledOscillator pair(plate(1e-2), grains(), implicit(Acceleration::iqn_ils));
  OscillatorBody body(plate(1e-2));
  OscillatorBed bed(grains());
  body.x = pair.body.x = 0.1;
  for (int i = 0; i < 20; ++i) {
    pair.advance(H);
    bed.advance(pair.exchange().path);
    body.advance(pair.exchange().applied);
    ASSERT_EQ(body.x, pair.body.x);
    ASSERT_EQ(body.v, pair.body.v);
    ASSERT_EQ(bed.y, pair.bed.y);
    ASSERT_EQ(bed.w, pair.bed.w);
  }
  EXPECT_GT(pair.coupler().counters().iterations, 20u);
}

}  // namespace implicit_test
}  // namespace tandem::test
