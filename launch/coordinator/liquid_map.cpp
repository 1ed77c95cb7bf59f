#include "launch/coordinator/liquid_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "common/math/spectral_radius.hpp"

namespace tandem::launch {
namespace {

// Growth below this counts as zero: eigenvalues of modulus one have round-off.
constexpr double growth_tolerance = 1e-7;

// Velocity of the walls over a window: linear in time.
struct Path {
  double begin = 0, end = 0;
  double at(double s) const { return begin + s * (end - begin); }
};

constexpr std::size_t remembered = 4;  // windows; no delay is longer

// Units: the mass of the body and the length of the window are one.
struct State {
  double body = 0, liquid = 0;          // velocities of the body and of the added mass
  double held = 0;                      // impulse of the last window
  std::array<Path, remembered> paths{};  // of the last windows, newest first
};

// u' = rate (V - u) over a time `length`, in which V goes along `path`.
double follow(double u, Path path, double rate, double length) {
  if (!(length > 0)) return u;
  const double slope = (path.end - path.begin) / length, x = rate * length;
  // Difference of the velocities, without loss of digits for a slow liquid.
  const double decay = -std::expm1(-x), lag = x > 1e-4 ? slope * (length - decay / rate) : 0.5 * slope * x * length;
  return u + decay * (path.begin - u) + lag;
}

class Liquid {
 public:
  Liquid(const LiquidMode& mode, double window)
      : ratio_(mode.ratio),
        rate_(mode.rate * window / mode.ratio),
        delay_(std::min(mode.delay_in(window) / window, static_cast<double>(remembered) - 1e-9)) {}

  // The impulse on the body over a window in which the walls follow `path`, and the state of the liquid.
  double impulse(State& state, Path path) const {
    const double before = state.liquid;
    const auto whole = static_cast<std::size_t>(delay_);
    const double late = delay_ - static_cast<double>(whole);
    const auto past = [&](std::size_t windows) { return windows == 0 ? path : state.paths[windows - 1]; };
    if (late > 0) {
      const Path old = past(std::min(whole + 1, remembered));
      state.liquid = follow(state.liquid, {old.at(1 - late), old.end}, rate_, late);
    }
    const Path now = past(whole);
    state.liquid = follow(state.liquid, {now.begin, now.at(1 - late)}, rate_, 1 - late);
    return ratio_ * (before - state.liquid);
  }

 private:
  double ratio_, rate_, delay_;
};

State advance(const scene::Coupling& how, const LiquidMode& mode, double window, const State& begin) {
  const Liquid liquid(mode, window);
  State end = begin;
  const double v = begin.body;
  const auto impulse = [&](Path path) {
    State scratch = begin;
    return liquid.impulse(scratch, path);
  };
  Path path{v, v};
  switch (how.scheme) {
    case scene::Scheme::parallel:
      end.body = v + begin.held;
      break;
    case scene::Scheme::mbd_first:
      end.body = v + begin.held;
      path.end = end.body;
      break;
    case scene::Scheme::dem_first:
      end.body = v + impulse(path);
      break;
    case scene::Scheme::linear_implicit:
      end.body = v + impulse(path) / (1 + mode.passed(window));
      break;
    case scene::Scheme::implicit: {
      // The impulse is affine in the change of velocity that it causes.
      const auto along = [&](double change) {
        return how.load == scene::LoadShape::mean ? Path{v + change / 2, v + change / 2} : Path{v, v + change};
      };
      const double without = impulse(along(0)), per_change = impulse(along(1)) - without;
      const double change = without / (1 - per_change);
      end.body = v + change;
      path = along(change);
      break;
    }
  }
  end.held = liquid.impulse(end, path);
  std::rotate(end.paths.rbegin(), end.paths.rbegin() + 1, end.paths.rend());
  end.paths[0] = path;
  return end;
}

template <class Visit>
void each(State& state, Visit visit) {
  for (double* value : {&state.body, &state.liquid, &state.held}) visit(*value);
  for (Path& path : state.paths) {
    visit(path.begin);
    visit(path.end);
  }
}

}  // namespace

double LiquidMode::delay_in(double window) const {
  return delay * window / std::max(1.0, std::ceil(window / step * (1 - 1e-9)));
}

double LiquidMode::passed(double window) const {
  return -ratio * std::expm1(-rate / ratio * std::max(0.0, window - delay_in(window)));
}

double growth(const scene::Coupling& how, const LiquidMode& mode, double window) {
  std::vector<double> map;  // column by column
  State zero;
  std::size_t size = 0;
  each(zero, [&size](double&) { ++size; });
  for (std::size_t i = 0; i < size; ++i) {
    State unit;
    std::size_t at = 0;
    each(unit, [&](double& value) { value = at++ == i ? 1 : 0; });
    State image = advance(how, mode, window, unit);
    each(image, [&](double& value) { map.push_back(value); });
  }
  return spectral_radius(map);
}

double critical_window(const scene::Coupling& how, const LiquidMode& mode) {
  const auto stable = [&](double window) { return growth(how, mode, window) <= 1 + growth_tolerance; };
  // The first window at which stability is lost, to 3 %, then refined by bisection.
  double low = 1e-3 / mode.rate;
  if (!stable(low)) return 0;
  double high = low;
  while (stable(high *= 1.03)) {
    low = high;
    if (high * mode.rate > 1e3 * (1 + mode.ratio) && high > 20 * mode.step)
      return std::numeric_limits<double>::infinity();
  }
  while (high - low > 1e-4 * low) {
    const double middle = (low + high) / 2;
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace tandem::launch
