#include "sph_server/io/fill.hpp"

#include <algorithm>
#include <cmath>

#include "sph_server/equations/hydrostatic.hpp"

namespace tandem::sph {
namespace {

bool contains(const scene::Box& box, Vec3d x, double margin) {
  for (int a = 0; a < 3; ++a)
    if (x[a] < box.min[a] - margin || x[a] > box.max[a] + margin) return false;
  return true;
}

// Distance from a point in the box to its surface in a direction [m].
double way_out(const scene::Box& box, Vec3d x, Vec3d direction) {
  double way = norm(box.max - box.min);
  for (int a = 0; a < 3; ++a)
    if (direction[a] != 0)
      way = std::min(way, ((direction[a] > 0 ? box.max[a] : box.min[a]) - x[a]) / direction[a]);
  return std::max(way, 0.0);
}

// Length of liquid from x in a direction, through boxes that touch [m].
double column(const std::vector<scene::Box>& boxes, Vec3d x, Vec3d direction, double spacing) {
  double length = 0;
  std::vector<bool> passed(boxes.size());
  for (bool further = true; further;) {
    further = false;
    // A point just beyond the end of the last box.
    const Vec3d at = x + (length + 1e-3 * spacing) * direction;
    for (std::size_t b = 0; b < boxes.size() && !further; ++b) {
      if (passed[b] || !contains(boxes[b], at, 0)) continue;
      passed[b] = further = true;
      length += way_out(boxes[b], x + length * direction, direction);
    }
  }
  return length;
}

}  // namespace

double Sites::deepest() const {
  return depth.empty() ? 0 : *std::ranges::max_element(depth);
}

std::vector<scene::Box> boxes_of(const scene::Liquid& liquid) {
  std::vector<scene::Box> boxes;
  for (const auto& fill : liquid.fill)
    if (const auto* box = std::get_if<scene::Box>(&fill)) boxes.push_back(*box);
  return boxes;
}

Sites sites_of(const scene::Liquid& liquid, double spacing, Vec3d gravity) {
  Sites sites;
  const std::vector<scene::Box> boxes = boxes_of(liquid);
  const double g = norm(gravity);
  const Vec3d down = g > 0 ? (1 / g) * gravity : Vec3d{};
  for (const scene::Box& box : boxes) {
    int count[3];
    Vec3d step;
    for (int a = 0; a < 3; ++a) {
      count[a] = static_cast<int>(std::round((box.max[a] - box.min[a]) / spacing));
      step[a] = (box.max[a] - box.min[a]) / count[a];
    }
    for (int k = 0; k < count[2]; ++k)
      for (int j = 0; j < count[1]; ++j)
        for (int i = 0; i < count[0]; ++i) {
          const Vec3d x = box.min + Vec3d{(i + 0.5) * step.x, (j + 0.5) * step.y, (k + 0.5) * step.z};
          sites.position.push_back(x);
          const double above = g > 0 ? column(boxes, x, -down, spacing) : 0,
                       below = g > 0 ? column(boxes, x, down, spacing) : 0;
          sites.above.push_back(above);
          sites.depth.push_back(above + below);
        }
  }
  return sites;
}

LiquidState fill_of(const Sites& sites, const scene::Liquid& liquid, const Liquid& properties) {
  LiquidState state;
  state.position = sites.position;
  state.velocity.assign(sites.position.size(), liquid.velocity);
  state.compression.assign(sites.position.size(), 0.0);
  const double g = norm(properties.gravity);
  if (liquid.pressure == scene::StartPressure::zero || g == 0) return state;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    const double column = sites.depth[i], above = depth_at_rest(properties, sites.above[i]),
                 below = depth_at_rest(properties, column) - above;
    state.position[i] += ((column - sites.above[i] - below) / g) * properties.gravity;
    state.compression[i] = at_rest(properties, above).compression;
  }
  return state;
}

}  // namespace tandem::sph
