// The domain of a liquid whose scene gives none.
#pragma once

#include "coordinator/scene/scene_file.hpp"

namespace tandem::launch {

// Gives the liquid a box, which the servers receive as if it stood in the scene, and says so in the notes:
// around its walls at the start, boxes of liquid and inlets, and on each side larger by the longest edge of
// that. It follows the body with the widest walls, where no inlet, plane or wall of the ground is left
// behind. The meshes of walls must be known. Throws Error{scene} where there is nothing to surround.
void surround_liquid(SceneFile& file);

}  // namespace tandem::launch
