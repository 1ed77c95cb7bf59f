#include "common/scene/stiffer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/time_step.hpp"

namespace tandem::scene {
namespace {

// Factor by which the stiffness grows [-].
double factor_of(const Dem& dem, double ratio) {
  return std::pow(0.95 * ratio, dem.contact == ContactLaw::hooke ? -2.0 : -2.5);
}

}  // namespace

std::string stiffer(const Dem& dem, double ratio) {
  const double factor = factor_of(dem, ratio);
  if (!has_own_stiffness(dem.contact)) {
    const Material& softest =
        *std::min_element(dem.materials.begin(), dem.materials.end(),
                          [](const auto& m, const auto& n) { return m.young < n.young; });
    return fmt::format("young = {:.2g} Pa (now {:.2g}) for the material '{}'", factor * softest.young,
                       softest.young, softest.name);
  }
  const bool linear = dem.contact == ContactLaw::hooke;
  const auto stiffness = [&](const Pair& p) { return linear ? p.spring_stiffness : p.normal_stiffness; };
  const Pair& softest =
      *std::min_element(dem.pairs.begin(), dem.pairs.end(),
                        [&](const auto& p, const auto& q) { return stiffness(p) < stiffness(q); });
  return fmt::format("{} = {:.2g} (now {:.2g}) for the pair '{}' and '{}'",
                     linear ? "spring_stiffness" : "normal_stiffness", factor * stiffness(softest),
                     stiffness(softest), dem.materials[softest.a.value].name,
                     dem.materials[softest.b.value].name);
}

double step_of_stiffer(const Dem& dem, double ratio) {
  return 1 / std::sqrt(factor_of(dem, ratio));
}

}  // namespace tandem::scene
