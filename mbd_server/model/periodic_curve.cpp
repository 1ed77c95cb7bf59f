#include "mbd_server/model/periodic_curve.hpp"

#include <algorithm>
#include <utility>

#include "common/math/interpolation.hpp"

namespace tandem::mbd {

// The points of the neighbouring periods make the curve smooth where periods meet. The effect of a point on a
// spline falls by 0.27 from knot to knot.
PeriodicCurve::PeriodicCurve(const std::vector<double>& arguments, const std::vector<double>& values,
                             const std::optional<double>& period, Smoothness smoothness) {
  range_ = *std::max_element(values.begin(), values.end()) - *std::min_element(values.begin(), values.end());
  std::vector<double> x = arguments, y = values;
  if (period) {
    constexpr int knots_beyond = 40;
    period_ = *period, begin_ = x.front(), rise_ = y.back() - y.front();
    const int intervals = static_cast<int>(arguments.size()) - 1, periods = 1 + knots_beyond / intervals;
    x.clear(), y.clear();
    for (int p = -periods; p <= periods; ++p)
      for (int k = 0; k < intervals; ++k) {
        x.push_back(arguments[static_cast<std::size_t>(k)] + p * period_);
        y.push_back(values[static_cast<std::size_t>(k)] + p * rise_);
      }
    x.push_back(arguments.front() + (periods + 1) * period_);
    y.push_back(values.front() + (periods + 1) * rise_);
  }
  curve_ = smoothness == Smoothness::slope ? monotone_cubic(x, y, Ends::straight) : natural_spline(x, y);
  for (std::size_t k = 0; k + 1 < x.size(); ++k)
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0})
      largest_slope_ = std::max(largest_slope_, std::abs(curve_.at(x[k] + share * (x[k + 1] - x[k])).first));
}

// Over more than a period a motion sees nothing of the curve.
double PeriodicCurve::unseen(double x0, double x1) const {
  if (range_ == 0 || !(x0 != x1)) return 0;
  if (x1 < x0) std::swap(x0, x1);
  if (period_ > 0 && x1 - x0 > period_) return 1;
  const double shift = period_ > 0 ? std::floor((x0 - begin_) / period_) * period_ : 0;
  const std::vector<double>& knots = curve_.knots();
  auto knot = std::upper_bound(knots.begin(), knots.end(), x0 - shift);
  if (knot == knots.end() || *knot + shift >= x1) return 0;
  const double y0 = at(x0).value, slope = (at(x1).value - y0) / (x1 - x0);
  double most = 0;
  for (; knot != knots.end() && *knot + shift < x1; ++knot)
    most = std::max(most, std::abs(at(*knot + shift).value - y0 - slope * (*knot + shift - x0)));
  return most / range_;
}

PeriodicCurve::Value PeriodicCurve::at(double x) const {
  if (period_ == 0) {
    // A natural spline has no curvature at its ends, so that straight lines continue it smoothly.
    const double first = curve_.knots().front(), last = curve_.knots().back();
    if (x > first && x < last) return curve_.at(x);
    const Value end = x > first ? curve_.before(curve_.knots().size() - 1) : curve_.after(0);
    return {end.value + end.first * (x - (x > first ? last : first)), end.first, 0};
  }
  const double periods = std::floor((x - begin_) / period_);
  Value v = curve_.at(x - periods * period_);
  v.value += periods * rise_;
  return v;
}

}  // namespace tandem::mbd
