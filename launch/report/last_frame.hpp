// The last frame of a finished run, read back from its HDF5 files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

struct Surface {
  std::string name;    // of the body
  bool fixed = false;  // the ground's
  TriangleMesh mesh;   // world [m]
};

struct LastFrame {
  std::vector<double> position;  // [m] (n x 3)
  std::vector<double> radius;    // [m] (n)
  std::vector<double> speed;     // [m/s] (n)
  std::vector<Surface> surfaces;
};

// Empty where the run has written no frame. Throws Error{resource} for a file that cannot be read.
LastFrame read_last_frame(const std::filesystem::path& folder);

}  // namespace tandem::launch
