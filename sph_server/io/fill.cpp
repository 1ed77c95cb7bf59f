#include "sph_server/io/fill.hpp"

#include <algorithm>
#include <cmath>

#include "sph_server/equations/hydrostatic.hpp"

namespace tandem::sph {
double Sites::deepest() const {
  return depth.empty() ? 0 : *std::ranges::max_element(depth);
}

std::vector<scene::Box> boxes_of(const scene::Liquid& liquid) {
  std::vector<scene::Box> boxes;
  for (const auto& fill : liquid.fill)
    if (const auto* box = std::get_if<scene::Box>(&fill)) boxes.push_back(*box);
  return boxes;
}

std::vector<Lattice> lattices_of(const scene::Liquid& liquid, double spacing) {
  std::vector<Lattice> all;
  std::size_t first = 0;
  for (std::size_t k = 0; k < liquid.fill.size(); ++k) {
    const auto* box = std::get_if<scene::Box>(&liquid.fill[k]);
    if (!box) continue;
    Lattice& l = all.emplace_back();
    l.box = *box;
    l.fill = k;
    l.first = first;
    std::size_t sites = 1;
    for (int a = 0; a < 3; ++a) {
      l.count[a] = static_cast<int>(std::round((box->max[a] - box->min[a]) / spacing));
      l.step[a] = (box->max[a] - box->min[a]) / l.count[a];
      sites *= static_cast<std::size_t>(l.count[a]);
    }
    first += sites;
  }
  return all;
}

Sites sites_of(const scene::Liquid& liquid, double spacing) {
  Sites sites;
  for (const Lattice& l : lattices_of(liquid, spacing))
    for (int k = 0; k < l.count[2]; ++k)
      for (int j = 0; j < l.count[1]; ++j)
        for (int i = 0; i < l.count[0]; ++i)
          sites.position.push_back(l.box.min +
                                   Vec3d{(i + 0.5) * l.step.x, (j + 0.5) * l.step.y, (k + 0.5) * l.step.z});
  return sites;
}

LiquidState fill_of(const Sites& sites, const scene::Liquid& liquid, const Liquid& properties,
                    Vec3d velocity) {
  LiquidState state;
  state.position = sites.position;
  state.velocity.assign(sites.position.size(), velocity);
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
