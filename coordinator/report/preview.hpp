// The start of a scene as a picture, with its extents and the names of bodies and joints.
#pragma once

#include <filesystem>

#include "common/scene/model.hpp"
#include "coordinator/report/frame.hpp"
#include "coordinator/report/pov_scene.hpp"

namespace tandem::launch {

// Where the names of bodies and joints belong.
std::vector<Label> labels_of(const scene::Scene& scene, const Frame& start);

// `start.value` has the group of each sphere, or what the colours of `scale` mean. Throws Error{resource}
// where POV-Ray is missing or fails, Error{usage} where there is nothing to see, or too much.
void draw_preview(const std::filesystem::path& out, const scene::Scene& scene, const Frame& start,
                  const std::string& title, const std::optional<ColourScale>& scale = {});

}  // namespace tandem::launch
