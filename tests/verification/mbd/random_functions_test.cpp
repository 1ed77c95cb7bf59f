// Random trees under random functions of time, from pulses of 1e-6 s to ramps of ten steps, with fixed steps,
// error control and extrapolation, against the explicit method at a tolerance of 1e-10: each is right within
// three times its stated error, or marked. Five hundred machines; with TANDEM_SOAK set, five thousand.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace random_functions_test {

using Json = nlohmann::json;
using scene::Interpolation;
using scene::JointType;
using scene::MotionOf;
using scene::RampMotion;
using scene::TableMotion;

constexpr double end = 0.4;  // [s]

class Generator {
 public:
  explicit Generator(std::uint64_t number) : random_(number) {
    constexpr double steps[] = {1e-3, 2e-3, 4e-3, 1e-2};
    step_ = steps[random_() % 4];
  }

  scene::Scene scene() {
    scene::Scene s = machines::empty({uniform(-9, 9), uniform(-9, 9), uniform(-9, 9)});
    const int bodies = 1 + static_cast<int>(random_() % 4);
    std::vector<Vec3d> places{{0, 0, 0}};
    bool given = false;
    for (int b = 0; b < bodies; ++b) {
      const auto parent = random_() % places.size();
      const Vec3d at = places[parent] + 0.2 * direction(), centre = at + uniform(.1, .4) * direction();
      const double I = uniform(.02, .1);
      const BodyId body =
          machines::add_body(s, "b" + std::to_string(b), uniform(.5, 2), {I, 1.2 * I, .9 * I}, centre);
      const bool revolute = random_() % 3 > 0;
      scene::Joint& joint = machines::add_joint(
          s, "j" + std::to_string(b), revolute ? JointType::revolute : JointType::prismatic,
          parent == 0 ? ground : BodyId{static_cast<std::uint32_t>(parent - 1)}, body, at, direction());
      places.push_back(centre);
      const auto kind = random_() % 4;
      if (kind == 0 || (b == bodies - 1 && !given)) {
        s.mbd->forces.push_back(
            scene::Actuator{"f" + std::to_string(b), JointId{static_cast<std::uint32_t>(b)}, force()});
        given = true;
      } else if (kind == 1 && b + 1 < bodies) {
        joint.motion = motion();
        given = true;
      } else {
        joint.rate = uniform(-1, 1);
      }
      if (kind != 1) joint.damping = uniform(0, .3);
    }
    s.coupling.window = step_;
    s.end_time = end;
    switch (random_() % 4) {
      case 0:
        s.mbd->integrator.error_tolerance = random_() % 2 ? 1e-6 : 1e-7;
        break;
      case 1:
        s.mbd->integrator.extrapolate = true;
        break;
      default:
        s.mbd->integrator.rho_inf = std::max(0., uniform(-.2, 1));
    }
    return s;
  }

 private:
  double uniform(double a, double b) { return a + (b - a) * static_cast<double>(random_() >> 11) * 0x1p-53; }
  Vec3d direction() {
    const Vec3d v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    return (1 / norm(v)) * v;
  }
  // From 1e-6 s to ten steps.
  double duration() { return std::exp(uniform(std::log(1e-6), std::log(10 * step_))); }

  // Points of a pulse between rests: values between -1 and 1.
  TableMotion table(double T, double size) {
    TableMotion t;
    double time = uniform(0, .2);
    t.times.push_back(time), t.values.push_back(0);
    constexpr Interpolation kinds[] = {Interpolation::monotone, Interpolation::linear, Interpolation::step,
                                       Interpolation::spline};
    t.interpolation = kinds[random_() % 4];
    const int points = 1 + static_cast<int>(random_() % 4);
    for (int k = 0; k < points; ++k)
      t.times.push_back(time += T * uniform(.5, 1.5)), t.values.push_back(size * uniform(-1, 1));
    t.times.push_back(time += T), t.values.push_back(random_() % 2 ? 0 : t.values.back());
    t.smoothing = 0.3 * T;
    return t;
  }
  scene::Motion force() {
    const double T = duration(), size = std::min(20., .5 / T);
    if (random_() % 3 == 0) return RampMotion{0, uniform(-1, 1) * std::min(10., size), uniform(0, .3), T};
    return table(T, size);
  }
  // Speeds of some metres or radians per second.
  scene::Motion motion() {
    const double T = duration(), size = std::min(.2, 2 * T);
    switch (random_() % 4) {
      case 0:
        return RampMotion{0, uniform(-1, 1) * size, uniform(0, .3), T};
      case 1:
        return RampMotion{0, uniform(-1, 1), uniform(0, .3), T, MotionOf::speed};
      default: {
        TableMotion t = table(T, size);
        // A spline that ends at speed is an impact, of which the method of the reference knows no more.
        if (t.interpolation == Interpolation::spline) t.interpolation = Interpolation::monotone;
        return t;
      }
    }
  }

  std::mt19937_64 random_;
  double step_ = 0;
};

scene::Scene reference_of(scene::Scene s) {
  s.mbd->integrator = {};
  s.mbd->integrator.method = scene::IntegrationMethod::dormand_prince;
  s.mbd->integrator.error_tolerance = 1e-8;
  s.mbd->integrator.min_step = 1e-14;
  return s;
}

// Largest over the bodies, of positions as a share of the size, and of angles.
double distance(MbdSolver& a, MbdSolver& b, double size) {
  double most = 0;
  const protocol::BodiesFrame is = a.observe(), should_be = b.observe();
  for (std::size_t k = 0; k < is.bodies.size(); ++k) {
    const Pose &p = is.bodies[k].pose, &q = should_be.bodies[k].pose;
    most = std::max({most, norm(p.p_WB - q.p_WB) / size, norm(rotation_vector(p.q_WB * q.q_WB.conjugate()))});
  }
  return most;
}

TEST(RandomFunctions, AreRightWithinTheirStatedErrorOrMarked) {
  const std::uint64_t count = std::getenv("TANDEM_SOAK") ? 5000 : 500;
  constexpr double bar = 2e-4;  // of the size, or rad
  std::uint64_t marked = 0, beyond = 0, far = 0, stated = 0;
  for (std::uint64_t n = 0; n < count; ++n) {
    const scene::Scene scene = Generator(n).scene();
    machines::WholeRun run(scene), exact(reference_of(scene));
    const Json facts = run.facts();
    const double error = distance(run.solver, exact.solver, facts["mbd_size_m"]);
    const Json &estimate = facts["mbd_position_error_estimate"], &sum = facts["mbd_local_error_sum"];
    const bool numeric = estimate.is_number();
    const double says = numeric ? estimate.get<double>() : sum.is_number() ? sum.get<double>() : 0;
    const bool is_marked = says > 0.01 || !facts["warnings"].empty();
    const double allowed = std::max(bar, 3 * says);
    marked += is_marked, stated += numeric;
    if (numeric && !is_marked && error > std::max(1e-8, 3 * says)) ++beyond;
    if (numeric && !is_marked && error > std::max(1e-7, 10 * says)) ++far;
    if (error > allowed || (numeric && error > std::max(1e-7, 3 * says)))
      std::printf("machine %3d: step %g s, %s: error %.2e, stated %.2e, sum of local errors %.2e%s\n",
                  static_cast<int>(n), scene.coupling.window,
                  scene.mbd->integrator.error_tolerance ? "error control"
                  : scene.mbd->integrator.extrapolate   ? "extrapolated"
                                                        : "fixed steps",
                  error, says, sum.is_number() ? sum.get<double>() : 0, is_marked ? ", marked" : "");
    if (!is_marked) {
      EXPECT_LT(error, allowed) << "machine " << n;
    }
  }
  std::printf(
      "%d machines: %d marked; %d with an estimate, of which %d are off by more than three times it, %d by "
      "more than ten\n",
      static_cast<int>(count), static_cast<int>(marked), static_cast<int>(stated), static_cast<int>(beyond),
      static_cast<int>(far));
}

}  // namespace random_functions_test
}  // namespace tandem::mbd
