// The last frame of a finished run, read back from its HDF5 files.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

// Where a body is, from three points of its surface.
struct PlacedFrame {
  Vec3d from, to;                           // one point, in the body's frame and in the world [m]
  std::array<Vec3d, 3> axes_from, axes_to;  // the same directions in both
  Vec3d point(Vec3d p_B) const;
};

struct Surface {
  std::string name;                       // of the body
  bool fixed = false;                     // the ground's
  TriangleMesh mesh;                      // world [m]
  std::optional<PlacedFrame> frame = {};  // absent for the ground, and where all points are in a line
};

struct LastFrame {
  std::vector<double> position;  // [m] (n x 3)
  std::vector<double> radius;    // [m] (n)
  std::vector<double> speed;     // [m/s] (n)
  std::vector<Surface> surfaces;
};

// `from` and `to`: the same points in the body's frame and in the world.
std::optional<PlacedFrame> placed_frame(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to);

// Empty where the run has written no frame. Throws Error{resource} for a file that cannot be read.
LastFrame read_last_frame(const std::filesystem::path& folder);

}  // namespace tandem::launch
