// Reads a scene: JSON text -> schema validation -> Scene with names resolved -> checks that a schema cannot express.
// Every error is an Error{ErrorCode::scene} whose where() is "FILE: path.inside[3].the.file", whose problem() gives
// the value, and whose hint() gives the nearest valid name or the remedy.
#pragma once

#include <filesystem>
#include <string>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"

namespace tandem::scene {

// `origin` names the text in errors: the file's path.
Scene parse(const std::string& text, const std::string& origin);

// The published schema (draft 7), as built in.
const std::string& schema();

// Physical checks of a parsed scene: inertia is that of a real body, pairs complete, wall poses, overlapping walls,
// domain holds the fills, window is a multiple of a nanosecond, micro step below the stable limit, zero spheres, ...
void validate(const Scene& scene, const std::string& origin);

}  // namespace tandem::scene
