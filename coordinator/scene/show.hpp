// The verbs preview and movie: what a scene or a run shows.
#pragma once

#include <filesystem>

#include "coordinator/report/frame.hpp"
#include "coordinator/report/movie.hpp"
#include "coordinator/scene/options.hpp"
#include "coordinator/scene/scene_file.hpp"

namespace tandem::launch {

// Bodies and walls at their poses of the scene.
Frame surfaces_at_start(const SceneFile& file);

// NAME_unsettled.png in the working folder, for SCENE/NAME.json.
std::filesystem::path unsettled_picture(const std::filesystem::path& scene);

// The spheres of a scene while they settle before the start, in the colours of their speeds: as they are when
// they have settled, or when they have had the time for it. Prints which move, and where.
void preview_unsettled(const std::filesystem::path& scene, std::filesystem::path out,
                       const Overrides& overrides = {});

// The start of a scene as a picture in `out`; empty: NAME_preview.png in the working folder. Throws the
// errors of the scene and of its files.
void preview(const std::filesystem::path& scene, std::filesystem::path out, const Overrides& overrides = {});

// The film of a run; its scene is read from where summary.json says, or from `scene`.
void movie(const std::filesystem::path& folder, const std::filesystem::path& scene,
           const MovieOptions& options);

}  // namespace tandem::launch
