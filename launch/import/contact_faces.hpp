// Faces of two parts that fit: a pin in a hole, or plane on plane.
#pragma once

#include <string>
#include <vector>

#include "launch/import/step_file.hpp"

namespace tandem::launch {

// In the world.
struct FittingFaces {
  enum class Kind { pin_in_hole, hole_on_hole, plane_on_plane } kind;
  std::size_t a = 0, b = 0;  // parts
  Vec3d point;               // middle of the axis that both have, or of the common area [m]
  Vec3d direction;           // of the axis, or normal out of part a
  double radius = 0;         // of the pin [m]
  double gap = 0;            // of the radii, or between the planes; negative: they overlap [m]
  double angle = 0;          // around the axis that both cover [rad]
  // Share of the shorter cylinder, or of the smaller plane face, that is common.
  double share = 0;
};

// All pairs of parts, in the order of the parts. Two axes are one within 1e-4 rad and 1/1000 of the radius,
// two radii are equal within 1/200, and two planes are one within 1e-3 rad and 1/10000 of the smaller part.
// Throws Error{scene} at `where`, the file, where more than a million pairs of parts are near each other.
std::vector<FittingFaces> fitting_faces(const StepFile& step, const std::string& where);

}  // namespace tandem::launch
