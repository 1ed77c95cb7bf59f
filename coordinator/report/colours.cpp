#include "coordinator/report/colours.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tandem::launch {
namespace {

constexpr std::array<Vec3d, 7> okabe_ito{{{0.902, 0.624, 0.000},    // orange
                                          {0.337, 0.706, 0.914},    // sky blue
                                          {0.835, 0.369, 0.000},    // vermilion
                                          {0.000, 0.620, 0.451},    // bluish green
                                          {0.800, 0.475, 0.655},    // reddish purple
                                          {0.000, 0.447, 0.698},    // blue
                                          {0.941, 0.894, 0.259}}};  // yellow
constexpr std::array<Vec3d, 9> tol_muted{{{0.200, 0.133, 0.533},    // indigo
                                          {0.867, 0.800, 0.467},    // sand
                                          {0.267, 0.667, 0.600},    // teal
                                          {0.533, 0.133, 0.333},    // wine
                                          {0.533, 0.800, 0.933},    // cyan
                                          {0.600, 0.600, 0.200},    // olive
                                          {0.800, 0.400, 0.467},    // rose
                                          {0.067, 0.467, 0.200},    // green
                                          {0.667, 0.267, 0.600}}};  // purple

// Lightness is linear in the value (nine colours of matplotlib's viridis, sRGB).
constexpr std::array<Vec3d, 9> viridis{{{0.267, 0.005, 0.329},
                                        {0.279, 0.175, 0.483},
                                        {0.230, 0.322, 0.546},
                                        {0.173, 0.449, 0.558},
                                        {0.128, 0.567, 0.551},
                                        {0.158, 0.684, 0.502},
                                        {0.369, 0.789, 0.383},
                                        {0.678, 0.864, 0.190},
                                        {0.993, 0.906, 0.144}}};

}  // namespace

Vec3d body_colour(std::size_t index) {
  const Vec3d hue = okabe_ito[index % okabe_ito.size()];
  switch (index / okabe_ito.size() % 3) {
    case 1:
      return 0.5 * hue;
    case 2:
      return 0.5 * (hue + Vec3d{1, 1, 1});
    default:
      return hue;
  }
}

Vec3d group_colour(std::size_t index) {
  return tol_muted[index % tol_muted.size()];
}

Vec3d bar_colour(double share) {
  // The darkest eighth is left out: most spheres are at rest and would form one black heap.
  const double place = (0.125 + 0.875 * std::clamp(share, 0.0, 1.0)) * (viridis.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), viridis.size() - 2);
  const double rest = place - static_cast<double>(below);
  return (1 - rest) * viridis[below] + rest * viridis[below + 1];
}

Vec3d ColourScale::colour(double value) const {
  if (!names.empty()) return group_colour(static_cast<std::size_t>(std::max(value, 0.0)));
  return bar_colour((value - low) / (high - low));
}

void ScaleRange::add(std::span<const double> values) {
  if (values.empty()) return;
  const auto [least, largest] = std::minmax_element(values.begin(), values.end());
  low_ = std::min(low_, *least);
  high_ = std::max(high_, *largest);
  std::vector<double> copy(values.begin(), values.end());
  const auto place = copy.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(copy.size() - 1));
  std::nth_element(copy.begin(), place, copy.end());
  most_ = std::max(most_, *place);
}

ColourScale ScaleRange::from_zero(const std::string& title) const {
  if (!(most_ > 0)) return {.title = title, .low = 0, .high = high_ > 0 ? high_ : 1, .exceeded = false};
  return {.title = title, .low = 0, .high = most_, .exceeded = high_ > most_};
}

ColourScale ScaleRange::whole(const std::string& title) const {
  if (low_ > high_) return {.title = title};
  // Equal values are one colour in the middle of the bar.
  const double half = low_ < high_ ? 0 : low_ != 0 ? 0.5 * std::abs(low_) : 0.5;
  return {.title = title, .low = low_ - half, .high = high_ + half, .exceeded = false};
}

std::vector<double> ticks(double low, double high) {
  const double rough = (high - low) / 4, power = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough) {
      step = factor * power;
      break;
    }
  std::vector<double> values;
  const double slack = 1e-9 * (high - low);
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; ++k) values.push_back(k * step);
  return values;
}

}  // namespace tandem::launch
