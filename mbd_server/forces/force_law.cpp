#include "mbd_server/forces/force_law.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::mbd {
namespace {

// Integral of the cubic from its left end to the share t of its length.
double area(double h, double y0, double y1, double m0, double m1, double t) {
  const double t2 = t * t, t3 = t2 * t, t4 = t3 * t;
  return h * (y0 * (t - t3 + t4 / 2) + y1 * (t3 - t4 / 2) + h * m0 * (t2 / 2 - 2 * t3 / 3 + t4 / 4) +
              h * m1 * (t4 / 4 - t3 / 3));
}

}  // namespace

ForceLaw::ForceLaw(double factor, const std::optional<scene::ForceTable>& table) : factor_(factor) {
  if (!table) return;
  factor_ = 0;
  x_ = table->arguments, y_ = table->values;
  const std::size_t n = x_.size();
  std::vector<double> secant(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) secant[i] = (y_[i + 1] - y_[i]) / (x_[i + 1] - x_[i]);
  slope_.resize(n);
  slope_.front() = secant.front(), slope_.back() = secant.back();
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double h0 = x_[i] - x_[i - 1], h1 = x_[i + 1] - x_[i], a = secant[i - 1], b = secant[i];
    // Weighted harmonic mean; an extreme of the data is one of the curve.
    slope_[i] = a * b <= 0 ? 0 : 3 * (h0 + h1) / ((2 * h1 + h0) / a + (h1 + 2 * h0) / b);
  }
  sum_.assign(n, 0);
  for (std::size_t i = 0; i + 1 < n; ++i)
    sum_[i + 1] = sum_[i] + area(x_[i + 1] - x_[i], y_[i], y_[i + 1], slope_[i], slope_[i + 1], 1);
}

std::size_t ForceLaw::interval(double x) const {
  const auto after = std::upper_bound(x_.begin(), x_.end(), x);
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after - x_.begin() - 1, 0, std::ssize(x_) - 2));
}

ForceLaw::Value ForceLaw::at(double x) const {
  if (x_.empty()) return {factor_ * x, factor_};
  if (x <= x_.front()) return {y_.front() + slope_.front() * (x - x_.front()), slope_.front()};
  if (x >= x_.back()) return {y_.back() + slope_.back() * (x - x_.back()), slope_.back()};
  const std::size_t i = interval(x);
  const double h = x_[i + 1] - x_[i], t = (x - x_[i]) / h, s = 1 - t;
  const double m0 = h * slope_[i], m1 = h * slope_[i + 1];
  return {y_[i] * s * s * (1 + 2 * t) + y_[i + 1] * t * t * (1 + 2 * s) + t * s * (m0 * s - m1 * t),
          (6 * t * s * (y_[i + 1] - y_[i]) + m0 * s * (1 - 3 * t) + m1 * t * (3 * t - 2)) / h};
}

double ForceLaw::primitive(double x) const {
  if (x <= x_.front() || x >= x_.back()) {
    const bool left = x <= x_.front();
    const double d = x - (left ? x_.front() : x_.back());
    return (left ? 0 : sum_.back()) + d * ((left ? y_.front() : y_.back()) +
                                           d / 2 * (left ? slope_.front() : slope_.back()));
  }
  const std::size_t i = interval(x);
  const double h = x_[i + 1] - x_[i];
  return sum_[i] + area(h, y_[i], y_[i + 1], slope_[i], slope_[i + 1], (x - x_[i]) / h);
}

double ForceLaw::energy(double x) const {
  return x_.empty() ? 0.5 * factor_ * x * x : primitive(x) - primitive(0);
}

}  // namespace tandem::mbd
