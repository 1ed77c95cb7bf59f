// An orientation that is no quaternion: Euler angles, an axis with an angle, or two axes.
#pragma once

#include "common/scene/node.hpp"

namespace tandem::scene {

// `node` is an object that conforms to the definition `rotation` of the schema.
Quat read_rotation(const Node& node);

}  // namespace tandem::scene
