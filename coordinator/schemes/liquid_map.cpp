#include "coordinator/schemes/liquid_map.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "common/math/spectral_radius.hpp"

namespace tandem::launch {
namespace {

// Growth below this counts as zero: eigenvalues of modulus one have round-off.
constexpr double growth_tolerance = 1e-7;
// Windows over which a load remembers the path of its body.
constexpr std::size_t most_remembered = 32;
// A load that still acts at the last point fades over this share of the time until then: it would not be
// passive if it stopped at once.
constexpr double tail_share = 0.5;

// Velocity of the walls over a window: linear in time.
struct Path {
  double begin = 0, end = 0;
};

struct State {
  double body = 0;         // velocity
  double held = 0;         // impulse of the last window
  double ahead = 0;        // impulse that the body has received before the liquid
  std::deque<Path> paths;  // of the last windows, newest first
};

// Impulse of a window by what happened `j` windows before.
struct Weight {
  double jump = 0;  // of the velocity at the begin of that window
  double ramp = 0;  // over that window
};

std::vector<Weight> weights_of(const LiquidMode& mode, double H) {
  const double end = mode.end_load() > 0 ? (1 + 4 * tail_share) * mode.time.back() : mode.time.back();
  const auto count =
      static_cast<std::size_t>(std::ceil(end / std::max({H, end / most_remembered, 1e-300}))) + 1;
  std::vector<Weight> weights;
  double mean_before = 0;
  for (std::size_t j = 0; j < count; ++j) {
    const double from = static_cast<double>(j) * H, to = from + H, mean = mode.mean(from, to, H);
    weights.push_back({mode.until(to, H) - (j == 0 ? 0 : mode.until(from, H)), mean - mean_before});
    mean_before = mean;
  }
  return weights;
}

class Liquid {
 public:
  explicit Liquid(std::vector<Weight> weights) : weights_(std::move(weights)) {}

  std::size_t remembered() const { return weights_.size(); }
  // On the body over a window in which its walls follow `now`.
  double impulse(const std::deque<Path>& before, Path now) const {
    double sum = 0;
    for (std::size_t j = 0; j < weights_.size(); ++j) {
      const Path path = j == 0 ? now : before[j - 1];
      // What was before the oldest path is at rest relative to it.
      const double last = j < before.size() ? before[j].end : path.begin;
      sum -= weights_[j].jump * (path.begin - last) + weights_[j].ramp * (path.end - path.begin);
    }
    return sum;
  }

 private:
  std::vector<Weight> weights_;
};

State advance(const scene::Coupling& how, const Liquid& liquid, double passed, const State& begin) {
  State end = begin;
  const double v = begin.body;
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
      end.body = v + liquid.impulse(begin.paths, path);
      break;
    case scene::Scheme::linear_implicit:
      end.body = v + (liquid.impulse(begin.paths, path) + begin.ahead) / (1 + passed);
      end.ahead = passed * (end.body - v);
      break;
    case scene::Scheme::implicit: {
      // The impulse is affine in the change of velocity that it causes.
      const auto along = [&](double change) {
        return how.load == scene::LoadShape::mean ? Path{v + change / 2, v + change / 2}
                                                  : Path{v, v + change};
      };
      const double without = liquid.impulse(begin.paths, along(0)),
                   per_change = liquid.impulse(begin.paths, along(1)) - without,
                   change = without / (1 - per_change);
      end.body = v + change;
      path = along(change);
      break;
    }
  }
  end.held = liquid.impulse(begin.paths, path);
  end.paths.push_front(path);
  end.paths.pop_back();
  return end;
}

template <class Visit>
void each(State& state, Visit visit) {
  visit(state.body);
  visit(state.held);
  visit(state.ahead);
  for (Path& path : state.paths) {
    visit(path.begin);
    visit(path.end);
  }
}

}  // namespace

double LiquidMode::until(double seconds, double window) const {
  const double scale = std::min(1.0, time.front() > 0 ? window / time.front() : 1);
  const double t = seconds / scale;
  if (t >= time.back()) {
    const double tail = tail_share * time.back();
    return scale * (impulse.back() - end_load() * tail * std::expm1((time.back() - t) / tail));
  }
  const auto next = static_cast<std::size_t>(std::ranges::upper_bound(time, t) - time.begin());
  const double t0 = next == 0 ? 0 : time[next - 1], i0 = next == 0 ? 0 : impulse[next - 1];
  return scale * (i0 + (t - t0) / (time[next] - t0) * (impulse[next] - i0));
}

// The mean load over the last third of the points.
double LiquidMode::end_load() const {
  const std::size_t from = time.size() - 1 - time.size() / 3;
  if (from + 1 >= time.size()) return 0;
  return std::max(0.0, (impulse.back() - impulse[from]) / (time.back() - time[from]));
}

double LiquidMode::mean(double from, double to, double window) const {
  constexpr int parts = 32;
  double sum = 0;
  for (int i = 0; i < parts; ++i) sum += until(from + (i + 0.5) / parts * (to - from), window);
  return sum / parts;
}

double growth(const scene::Coupling& how, const LiquidMode& mode, double window) {
  const Liquid liquid(weights_of(mode, window));
  State zero;
  zero.paths.resize(liquid.remembered());
  std::size_t size = 0;
  each(zero, [&size](double&) { ++size; });
  std::vector<double> map;  // column by column
  for (std::size_t i = 0; i < size; ++i) {
    State unit = zero;
    std::size_t at = 0;
    each(unit, [&](double& value) { value = at++ == i ? 1 : 0; });
    State image = advance(how, liquid, mode.passed(window), unit);
    each(image, [&map](double& value) { map.push_back(value); });
  }
  return spectral_radius(map);
}

double critical_window(const scene::Coupling& how, const LiquidMode& mode) {
  const auto stable = [&](double window) { return growth(how, mode, window) <= 1 + growth_tolerance; };
  // The first window at which stability is lost, to 3 %, then refined by bisection.
  double low = 1e-3 * std::max(mode.time.front(), 1e-3 * mode.time.back());
  if (!(low > 0)) return stable(1) ? std::numeric_limits<double>::infinity() : 0;
  if (!stable(low)) return 0;
  double high = low;
  while (stable(high *= 1.03)) {
    low = high;
    if (high > 2 * mode.time.back()) return std::numeric_limits<double>::infinity();
  }
  while (high - low > 1e-4 * low) {
    const double middle = (low + high) / 2;
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace tandem::launch
