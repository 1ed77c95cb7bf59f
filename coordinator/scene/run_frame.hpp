// The spheres of a frame of another run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/particle_file.hpp"

namespace tandem::launch {

struct RunFrame {
  scene::ParticleFile spheres;              // with radius, velocity and spin
  double time = 0;                          // [s]
  std::vector<std::filesystem::path> read;  // the files
};

// The frame at `time`, or the last one. `where` names the fill in errors. Throws Error{scene} with the times
// of the frames where none is at `time`, and where the folder has no particle frames.
RunFrame read_run_frame(const std::filesystem::path& folder, std::optional<double> time,
                        const std::string& where);

}  // namespace tandem::launch
