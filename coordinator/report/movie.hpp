// The film of a run, one picture for each frame, from a camera that stands still.
#pragma once

#include <filesystem>
#include <string>

#include "common/scene/model.hpp"
#include "coordinator/report/pov_scene.hpp"

namespace tandem::launch {

struct MovieOptions {
  std::filesystem::path out;      // empty: FOLDER/movie.mp4
  double frames_per_second = 25;  // of the film
  PictureSize size;
  std::string colour_by = "speed";  // a dataset of the spheres
};

// Parses "1280x720"; throws Error{usage}.
PictureSize parse_picture_size(const std::string& text);

// Throws Error{usage} where the run has fewer than two frames, Error{resource} where POV-Ray or ffmpeg is
// missing or fails. Returns the file.
std::filesystem::path make_movie(const std::filesystem::path& folder, const scene::Scene& scene,
                                 const MovieOptions& options);

}  // namespace tandem::launch
