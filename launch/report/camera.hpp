// The camera of the picture.
#pragma once

#include "common/scene/model.hpp"
#include "launch/report/last_frame.hpp"

namespace tandem::launch {

// Against gravity; z where there is no gravity [-].
Vec3d upwards(const scene::Scene& scene);

// A view from the front, a little from the right and from above, onto the broad side of the scene.
// `aspect` = width / height of the picture.
scene::Camera automatic_camera(const LastFrame& frame, Vec3d up, double aspect);

}  // namespace tandem::launch
