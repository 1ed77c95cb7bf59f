#include "common/scene/material_library.hpp"

#include <algorithm>

namespace tandem::scene {
namespace {

constexpr std::nullopt_t none = std::nullopt;

}  // namespace

const std::vector<LibraryMaterial>& library_materials() {
  static const std::vector<LibraryMaterial> materials{
#define TANDEM_MATERIAL(name, kind, density, young, poisson, viscosity, source) \
  {#name, kind, density, young, poisson, viscosity, source},
#include "common/scene/materials.def"
#undef TANDEM_MATERIAL
  };
  return materials;
}

const std::vector<LibraryPair>& library_pairs() {
  static const std::vector<LibraryPair> pairs{
#define TANDEM_MATERIAL_PAIR(a, b, restitution, friction, source) {#a, #b, restitution, friction, source},
#include "common/scene/material_pairs.def"
#undef TANDEM_MATERIAL_PAIR
  };
  return pairs;
}

std::vector<std::string> library_solids() {
  std::vector<std::string> names;
  for (const LibraryMaterial& material : library_materials())
    if (!material.viscosity) names.emplace_back(material.name);
  return names;
}

std::vector<std::string> library_liquids() {
  std::vector<std::string> names;
  for (const LibraryMaterial& material : library_materials())
    if (material.viscosity) names.emplace_back(material.name);
  return names;
}

const LibraryMaterial* find_library_material(std::string_view name) {
  const auto found = std::ranges::find(library_materials(), name, &LibraryMaterial::name);
  return found == library_materials().end() ? nullptr : &*found;
}

const LibraryPair* find_library_pair(std::string_view a, std::string_view b) {
  const auto found = std::ranges::find_if(library_pairs(), [&](const LibraryPair& pair) {
    return (pair.a == a && pair.b == b) || (pair.a == b && pair.b == a);
  });
  return found == library_pairs().end() ? nullptr : &*found;
}

}  // namespace tandem::scene
