#include "sph_server/equations/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "common/error.hpp"
#include "common/scene/fault.hpp"

namespace tandem::sph {

StepLimits step_limits(const Liquid& liquid, double v, double a) {
  const double h = liquid.h(), never = std::numeric_limits<double>::infinity();
  StepLimits s;
  s.sound = 0.3 * h / (liquid.sound_speed + v);
  s.viscous = liquid.viscosity > 0 ? 0.05 * h * h * liquid.density / liquid.viscosity : never;
  s.force = a > 0 ? 0.25 * std::sqrt(h / a) : never;
  s.smallest = std::min({s.sound, s.viscous, s.force});
  return s;
}

double extrapolation_weight(double dt, double last) {
  constexpr double largest_ratio = 2;
  if (!(last > 0)) return 0.5;
  return dt <= largest_ratio * last ? 0.5 * dt / last : 0;
}

double suggested_sound_speed(double v, double gravity, double depth) {
  return 10 * std::max(v, std::sqrt(gravity * depth));
}

void expect_liquid(const Liquid& l) {
  const auto expect = [](bool right, const char* name, double value, const char* range) {
    if (!right)
      throw Error(ErrorCode::scene, std::string(name) + " of the liquid is " + scene::rounded(value), name,
                  std::string("give a value ") + range);
  };
  expect(l.density > 0 && std::isfinite(l.density), "density", l.density, "above 0 kg/m3");
  expect(l.viscosity >= 0 && std::isfinite(l.viscosity), "viscosity", l.viscosity, "of 0 Pa s or more");
  expect(l.sound_speed > 0 && std::isfinite(l.sound_speed), "sound_speed", l.sound_speed, "above 0 m/s");
  expect(l.spacing > 0 && std::isfinite(l.spacing), "spacing", l.spacing, "above 0 m");
  expect(l.smoothing >= 1.2 && l.smoothing <= 2.5, "smoothing", l.smoothing, "from 1.2 to 2.5");
  expect(l.diffusion >= 0 && l.diffusion <= 0.2, "diffusion", l.diffusion, "from 0 to 0.2");
  expect(l.bulk_viscosity >= 0 && l.bulk_viscosity <= 1, "bulk_viscosity", l.bulk_viscosity, "from 0 to 1");
  expect(l.shifting >= 0 && l.shifting <= 10, "shifting", l.shifting, "from 0 to 10");
  expect(l.artificial >= 0 && l.artificial <= 1, "artificial", l.artificial, "from 0 to 1");
}

}  // namespace tandem::sph
