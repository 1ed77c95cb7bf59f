#include "dem_server/laws/stiffer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dem_server/laws/generic.hpp"

namespace tandem::dem {
namespace {

StiffnessKey stiffness_of(scene::ContactLaw law) {
  return with_law(law, [](auto l) { return decltype(l)::stiffness; });
}

// Factor by which the stiffness grows [-].
double factor_of(const scene::Dem& dem, double ratio) {
  return std::pow(0.95 * ratio, 1 / stiffness_of(dem.contact).overlap_exponent);
}

}  // namespace

std::string stiffer(const scene::Dem& dem, double ratio) {
  const StiffnessKey stiffness = stiffness_of(dem.contact);
  const double factor = factor_of(dem, ratio);
  if (!stiffness.of_pair) {
    const scene::Material& softest =
        *std::min_element(dem.materials.begin(), dem.materials.end(),
                          [](const auto& m, const auto& n) { return m.young < n.young; });
    return fmt::format("young = {:.2g} Pa (now {:.2g}) for the material '{}'", factor * softest.young,
                       softest.young, softest.name);
  }
  const auto of_pair = stiffness.of_pair;
  const scene::Pair& softest =
      *std::min_element(dem.pairs.begin(), dem.pairs.end(),
                        [&](const auto& p, const auto& q) { return p.*of_pair < q.*of_pair; });
  return fmt::format("{} = {:.2g} (now {:.2g}) for the pair '{}' and '{}'", stiffness.key,
                     factor * softest.*of_pair, softest.*of_pair, dem.materials[softest.a.value].name,
                     dem.materials[softest.b.value].name);
}

double step_of_stiffer(const scene::Dem& dem, double ratio) {
  return 1 / std::sqrt(factor_of(dem, ratio));
}

}  // namespace tandem::dem
