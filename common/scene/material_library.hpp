// Materials that tandem ships, with the source of each figure (docs/materials.md). What no source has is
// absent.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tandem::scene {

struct LibraryMaterial {
  const char* name;
  const char* kind;                 // "metal", "plastic", "mineral", "bulk solid", "liquid"
  double density;                   // of the substance, not of the bulk [kg/m3]
  std::optional<double> young;      // [Pa]
  std::optional<double> poisson;    // [-]
  std::optional<double> viscosity;  // of a liquid, dynamic [Pa s]
  const char* source;               // key of docs/materials.md
};

struct LibraryPair {
  const char *a, *b;                  // in either order
  std::optional<double> restitution;  // [-]
  std::optional<double> friction;     // [-]
  const char* source;
};

const std::vector<LibraryMaterial>& library_materials();
const std::vector<LibraryPair>& library_pairs();
// Their names: of what grains, walls and bodies can be of, and of what liquids can be of.
std::vector<std::string> library_solids();
std::vector<std::string> library_liquids();
// Null where there is none.
const LibraryMaterial* find_library_material(std::string_view name);
const LibraryPair* find_library_pair(std::string_view a, std::string_view b);

}  // namespace tandem::scene
