#include "sph_server/engine/probe.hpp"

#include <algorithm>
#include <cmath>

#include "sph_server/kernel/wendland.hpp"

namespace tandem::sph {
namespace {

constexpr double in_front = 0.02;   // of a point, from where it looks [spacings]
constexpr double line_step = 0.25;  // of the search along a line [spacings]
constexpr int bisections = 30;
constexpr int samples_of_support = 4;  // of the hidden part, along a radius of the kernel

}  // namespace

std::vector<particles::Facet> Probe::facets_near(Vec3d x) const {
  std::vector<particles::Facet> near;
  const WallsView walls = walls_.view();
  walls.for_near(x, liquid_.support(), [&](std::uint32_t number) {
    const NearFacet f = walls.in_world(number);
    particles::Facet& facet = near.emplace_back();
    facet.a = f.a;
    facet.b = f.b;
    facet.c = f.c;
    facet.normal = f.normal;
    return true;
  });
  return near;
}

bool Probe::sees(const std::vector<particles::Facet>& near, Vec3d x, Vec3d y) const {
  const double r = norm(y - x);
  if (r == 0) return true;
  const double share = std::min(0.5, in_front * liquid_.spacing / r);
  const Vec3d from = x + share * (y - x);
  return std::ranges::none_of(
      near, [&](const particles::Facet& facet) { return crosses(facet, from, y, walls_.margin()); });
}

double Probe::pressure_at(Vec3d x) const {
  const double R = liquid_.support();
  const auto kernel = Kernel<double>::of_support(R);
  const std::vector<particles::Facet> near = facets_near(x);
  double weight = 0, sum = 0;
  for (std::size_t i = 0; i < state_.size(); ++i) {
    const Vec3d d = periods_.shortest(state_.position[i] - x);
    if (!(norm2(d) < R * R) || !sees(near, x, x + d)) continue;
    const double w = volume(i) * kernel.value(norm(d));
    weight += w;
    sum += w * (state_.pressure[i] - dot(state_.slope[i], d));
  }
  return weight > 0 ? sum / weight : 0;
}

bool Probe::is_liquid(Vec3d x, const std::vector<std::size_t>& particles) const {
  const double R = liquid_.support(), step = R / samples_of_support;
  const auto kernel = Kernel<double>::of_support(R);
  const std::vector<particles::Facet> near = facets_near(x);
  double sum = 0;
  for (const std::size_t i : particles) {
    const Vec3d d = periods_.shortest(state_.position[i] - x);
    if (norm2(d) < R * R && sees(near, x, x + d)) sum += volume(i) * kernel.value(norm(d));
  }
  if (!(sum > 0)) return false;
  if (near.empty() || sum >= 0.5) return sum >= 0.5;
  // The part that walls leave, by samples on a cubic lattice, as far as the answer needs it.
  struct Sample {
    Vec3d d;
    double weight;
  };
  std::vector<Sample> samples;
  double all = 0;
  for (int k = -samples_of_support; k < samples_of_support; ++k)
    for (int j = -samples_of_support; j < samples_of_support; ++j)
      for (int i = -samples_of_support; i < samples_of_support; ++i) {
        const Vec3d d = step * Vec3d{i + 0.5, j + 0.5, k + 0.5};
        if (!(norm2(d) < R * R)) continue;
        samples.push_back({d, kernel.value(norm(d))});
        all += samples.back().weight;
      }
  double seen = 0, hidden = 0;
  for (const Sample& s : samples) {
    (sees(near, x, x + s.d) ? seen : hidden) += s.weight;
    if (seen > 2 * sum * all) return false;
    if (all - hidden <= 2 * sum * all) return true;
  }
  return seen <= 2 * sum * all;
}

double Probe::level_on(Vec3d from, Vec3d along) const {
  const double R = liquid_.support();
  std::vector<std::size_t> near_line;
  double low = 0, high = 0;
  for (std::size_t i = 0; i < state_.size(); ++i) {
    const Vec3d d = periods_.shortest(state_.position[i] - from);
    const double s = dot(d, along);
    if (!(norm2(d - s * along) < R * R)) continue;
    low = near_line.empty() ? s : std::min(low, s);
    high = near_line.empty() ? s : std::max(high, s);
    near_line.push_back(i);
  }
  if (near_line.empty()) return 0;
  const double step = line_step * liquid_.spacing;
  double above = high + R;
  while (above >= low - R && !is_liquid(from + (above - step) * along, near_line)) above -= step;
  if (above < low - R) return 0;
  double below = above - step;
  for (int k = 0; k < bisections; ++k) {
    const double middle = 0.5 * (below + above);
    (is_liquid(from + middle * along, near_line) ? below : above) = middle;
  }
  return below;
}

}  // namespace tandem::sph
