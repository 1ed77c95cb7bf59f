#include "common/scene/sizes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace tandem::scene {

namespace {

double volume_of_sphere(double radius) {
  return 4.0 / 3 * std::numbers::pi * radius * radius * radius;
}

// Spheres between two radii with a share of the volume of all.
struct SizeClass {
  double share = 0;                        // of the volume [-]
  double mean_volume = 0;                  // of a sphere [m3]
  std::function<double(double)> quantile;  // radius, of the number from 0 to 1
};

// Mean volume over the quantiles. Smooth quantiles need few points.
double mean_volume(const std::function<double(double)>& quantile) {
  constexpr int points = 4096;
  double sum = 0;
  for (int k = 0; k < points; ++k) sum += volume_of_sphere(quantile((k + 0.5) / points));
  return sum / points;
}

SizeClass one_radius(double share, double radius) {
  return {share, volume_of_sphere(radius), [radius](double) { return radius; }};
}

// Uniform mass over the diameter from a to b: a number over d^-3. The number below d is proportional to
// a^-2 - d^-2.
SizeClass between_sieves(double share, double a, double b) {
  const double low = 1 / (a * a), high = 1 / (b * b);
  const double mean = std::numbers::pi / 6 * (b - a) / (0.5 * (low - high));
  return {share, mean, [low, high](double q) { return 0.5 / std::sqrt(low + q * (high - low)); }};
}

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

// x at which the normal distribution, cut off at low and high, reaches q.
double cut_normal_quantile(double q, double low, double high) {
  const double target = normal_cdf(low) + q * (normal_cdf(high) - normal_cdf(low));
  double a = low, b = high;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (a + b);
    (normal_cdf(middle) < target ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

SizeClass single(std::function<double(double)> quantile) {
  const double mean = mean_volume(quantile);
  return {1, mean, std::move(quantile)};
}

std::vector<SizeClass> classes_of(const ParticleGroup& group) {
  if (!group.sizes)
    return {group.radius_min == group.radius_max
                ? one_radius(1, group.radius_min)
                : single([a = group.radius_min, b = group.radius_max](double q) { return a + q * (b - a); })};
  std::vector<SizeClass> classes;
  if (const auto* list = std::get_if<ListedSizes>(&*group.sizes)) {
    for (std::size_t i = 0; i < list->radius.size(); ++i)
      classes.push_back(one_radius(list->mass_fraction[i], list->radius[i]));
  } else if (const auto* sieve = std::get_if<SieveCurve>(&*group.sizes)) {
    for (std::size_t i = 0; i + 1 < sieve->size.size(); ++i)
      if (sieve->passing[i + 1] > sieve->passing[i])
        classes.push_back(
            between_sieves(sieve->passing[i + 1] - sieve->passing[i], sieve->size[i], sieve->size[i + 1]));
  } else if (const auto* normal = std::get_if<NormalSizes>(&*group.sizes)) {
    const NormalSizes n = *normal;
    classes.push_back(single([n](double q) {
      return std::clamp(n.mean + n.deviation * cut_normal_quantile(q, (n.min - n.mean) / n.deviation,
                                                                   (n.max - n.mean) / n.deviation),
                        n.min, n.max);
    }));
  } else {
    const LogNormalSizes n = std::get<LogNormalSizes>(*group.sizes);
    classes.push_back(single([n](double q) {
      const double x = cut_normal_quantile(q, std::log(n.min / n.median) / n.deviation,
                                           std::log(n.max / n.median) / n.deviation);
      return std::clamp(n.median * std::exp(n.deviation * x), n.min, n.max);
    }));
  }
  return classes;
}

void append(std::vector<double>& radii, const SizeClass& of, std::uint64_t count) {
  for (std::uint64_t k = 0; k < count; ++k)
    radii.push_back(of.quantile((static_cast<double>(k) + 0.5) / static_cast<double>(count)));
}

}  // namespace

void set_radius_limits(ParticleGroup& group) {
  const Sizes& sizes = group.sizes.value();
  if (const auto* list = std::get_if<ListedSizes>(&sizes)) {
    group.radius_min = *std::ranges::min_element(list->radius);
    group.radius_max = *std::ranges::max_element(list->radius);
  } else if (const auto* sieve = std::get_if<SieveCurve>(&sizes)) {
    group.radius_min = sieve->size.front() / 2;
    group.radius_max = sieve->size.back() / 2;
  } else if (const auto* normal = std::get_if<NormalSizes>(&sizes)) {
    group.radius_min = normal->min;
    group.radius_max = normal->max;
  } else {
    group.radius_min = std::get<LogNormalSizes>(sizes).min;
    group.radius_max = std::get<LogNormalSizes>(sizes).max;
  }
}

std::vector<double> radii_of_volume(const ParticleGroup& group, double volume) {
  std::vector<double> radii;
  // What a class has too much or too little, by rounding, the next one gets less or more.
  double wanted = 0, there = 0;
  for (const SizeClass& of : classes_of(group)) {
    wanted += of.share * volume;
    const auto count =
        static_cast<std::uint64_t>(std::llround(std::fmax(0, (wanted - there) / of.mean_volume)));
    const std::size_t first = radii.size();
    append(radii, of, count);
    for (std::size_t i = first; i < radii.size(); ++i) there += volume_of_sphere(radii[i]);
  }
  return radii;
}

std::vector<double> radii_of_count(const ParticleGroup& group, std::uint64_t count) {
  const std::vector<SizeClass> classes = classes_of(group);
  double numbers = 0;  // of spheres in a unit of volume
  for (const SizeClass& of : classes) numbers += of.share / of.mean_volume;
  std::vector<double> radii;
  double wanted = 0;
  for (const SizeClass& of : classes) {
    wanted += of.share / of.mean_volume / numbers * static_cast<double>(count);
    const auto until = std::min(count, static_cast<std::uint64_t>(std::llround(wanted)));
    append(radii, of, &of == &classes.back() ? count - radii.size() : until - radii.size());
  }
  return radii;
}

double volume_of(const std::vector<double>& radii) {
  double sum = 0;
  for (const double radius : radii) sum += volume_of_sphere(radius);
  return sum;
}

}  // namespace tandem::scene
