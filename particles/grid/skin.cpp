#include "particles/grid/skin.hpp"

#include <algorithm>

#include "common/scene/model.hpp"

namespace tandem::particles {

SkinRange skins_of(const scene::Dem& dem, const std::vector<double>& radii) {
  if (radii.empty()) return {};
  double sum = 0;
  for (const double r : radii) sum += r;
  SkinRange skins;
  skins.usual = 0.25 * sum / static_cast<double>(radii.size());
  skins.smallest = skins.usual / 16;
  // Cells are made for the largest skin, so that a larger one makes each rebuild search more space.
  skins.largest = 2 * skins.usual;
  // A period has at least three cells, also after it is rounded to quanta of positions.
  constexpr double rounding = 1e-8;
  const double diameter = 2 * *std::max_element(radii.begin(), radii.end());
  for (int a = 0; a < 3; ++a)
    if (dem.periodic[static_cast<std::size_t>(a)]) {
      const double period = (dem.domain.max[a] - dem.domain.min[a]) * (1 - rounding);
      skins.largest = std::min(skins.largest, period / 3 - diameter);
    }
  skins.largest = std::max(skins.largest, skins.usual);
  if (dem.skin) skins.smallest = skins.largest = *dem.skin;
  return skins;
}

}  // namespace tandem::particles
