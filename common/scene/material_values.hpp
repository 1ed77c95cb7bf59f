// Figures of materials that a scene takes from the library (common/scene/material_library.hpp).
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "common/scene/parameter.hpp"

namespace tandem::scene {

// Does the text have the name of a material of the library in quotes?
bool may_use_library(const std::string& text);

// Refuses names that are neither of the scene nor of the library, but nearly of the library, and others where
// the scene has no list of materials.
void expect_known_materials(const nlohmann::json& document, const std::string& origin);

// Completes materials of `dem` that leave out density, young or poisson, adds those that particles and walls
// use but `dem.materials` does not list, adds what is known of pairs of such materials, and completes liquids
// that leave out density or viscosity. Returns the figures taken, as "steel.density"; where there are none
// the document stays as it is. Throws Error{scene} for a figure that the library does not have either.
std::vector<Parameter> put_in_materials(nlohmann::ordered_json& document, const std::string& origin);

}  // namespace tandem::scene
