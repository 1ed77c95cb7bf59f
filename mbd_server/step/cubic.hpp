// The path of a coordinate within a step, from its values and rates at both ends.
#pragma once

namespace tandem::mbd {

// Cubic in [0, 1] with the given values and slopes at its ends.
struct Cubic {
  double y0, s0, y1, s1;
  double operator()(double t) const {
    const double r = 1 - t;
    return r * r * ((1 + 2 * t) * y0 + t * s0) + t * t * ((3 - 2 * t) * y1 - r * s1);
  }
  double slope(double t) const {
    return 6 * t * (1 - t) * (y1 - y0) + (1 - t) * (1 - 3 * t) * s0 + t * (3 * t - 2) * s1;
  }
};

// Position at which f, negative at `low` and positive at 1, changes its sign.
template <class F>
double bisect(F&& f, double low = 0) {
  double high = 1;
  for (int i = 0; i < 50; ++i) {
    const double t = (low + high) / 2;
    (f(t) < 0 ? low : high) = t;
  }
  return high;
}

}  // namespace tandem::mbd
