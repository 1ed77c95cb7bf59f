// A number with its derivatives by N arguments: a law that is written once as a template gives its value and
// its exact derivatives.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace tandem::mbd {

template <int N>
struct Dual {
  using Gradient = Eigen::Matrix<double, 1, N>;
  double value = 0;
  Gradient by = Gradient::Zero();

  Dual() = default;
  Dual(double number) : value(number) {}  // NOLINT: a constant is a number without derivatives
  Dual(double number, const Gradient& gradient) : value(number), by(gradient) {}
  static Dual argument(double number, int index) {
    Dual x(number);
    x.by[index] = 1;
    return x;
  }

  friend Dual operator-(const Dual& a) { return {-a.value, -a.by}; }
  friend Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, a.by + b.by}; }
  friend Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, a.by - b.by}; }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.value * b.by + b.value * a.by};
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const double ratio = a.value / b.value;
    return {ratio, (a.by - ratio * b.by) / b.value};
  }
};

// At zero the derivative is that of the smooth side where there is none.
template <int N>
Dual<N> sqrt(const Dual<N>& a) {
  const double root = std::sqrt(a.value);
  if (root == 0) return {};
  return {root, a.by / (2 * root)};
}
template <int N>
Dual<N> abs(const Dual<N>& a) {
  return a.value < 0 ? -a : a;
}
template <int N>
Dual<N> tanh(const Dual<N>& a) {
  const double t = std::tanh(a.value);
  return {t, (1 - t * t) * a.by};
}

inline double value_of(double a) {
  return a;
}
template <int N>
double value_of(const Dual<N>& a) {
  return a.value;
}

}  // namespace tandem::mbd
