// Parameters of a scene: named numbers, which expressions in the place of other numbers use. They are put in
// before the scene is checked; everything that comes after sees plain numbers.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/scene/parameter.hpp"

namespace tandem::scene {

// Replaces "parameters" and all expressions, strings that begin with '=', in a scene. set: values that
// replace those of parameters, in their units. Returns the parameters in the order of their names; text
// without parameters and expressions remains as it is.
// Throws Error{scene} with the path of a wrong parameter or expression, and Error{usage} for a wrong `set`.
std::vector<Parameter> put_in_parameters(std::string& text, const std::map<std::string, double>& set,
                                         const std::string& origin);

}  // namespace tandem::scene
