// The verbs preview and movie: what a scene or a run shows.
#pragma once

#include <filesystem>

#include "launch/coordinator/options.hpp"
#include "launch/report/movie.hpp"

namespace tandem::launch {

// The start of a scene as a picture in `out`; empty: NAME_preview.png in the working folder. Throws the
// errors of the scene and of its files.
void preview(const std::filesystem::path& scene, std::filesystem::path out, const Overrides& overrides = {});

// The film of a run; its scene is read from where summary.json says, or from `scene`.
void movie(const std::filesystem::path& folder, const std::filesystem::path& scene,
           const MovieOptions& options);

}  // namespace tandem::launch
