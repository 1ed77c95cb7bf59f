// The text of a scene for the solvers.
#pragma once

#include <string>

#include "common/scene/model.hpp"

namespace tandem::scene {

// In the plain form, with masses as numbers and without shapes but those of contact between bodies; those
// that are walls are in dem.walls, as meshes where the particles know no surface of their kind. `scene` is
// that of `text`, its masses known.
std::string plain_text(const std::string& text, const Scene& scene, const std::string& origin);

// For programs that receive that text: refuses a scene with a mass that is not known yet.
void expect_masses(const Scene& scene, const std::string& origin);

}  // namespace tandem::scene
