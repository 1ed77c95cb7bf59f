// The smooth parts of a surface, and how much of the particles each of them hides from the eye.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "coordinator/report/frame.hpp"

namespace tandem::launch {

struct Patch {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double hidden = 0;  // share of the particles behind it, from 0 to 1
};

// The triangles of a mesh, joined across edges at less than 30 degrees: of a box its faces, of a cylinder its
// side and its ends.
std::vector<Patch> patches_of(const TriangleMesh& mesh);

// Some hundred centres of spheres and vertices of the liquid, evenly chosen from all.
std::vector<Vec3d> points_to_see(const Frame& frame);

// Counts how many of the points each patch is in front of.
void count_hidden(std::vector<Patch>& patches, const TriangleMesh& mesh, const std::vector<Vec3d>& points,
                  Vec3d eye);

// How transparent a patch is that hides this share of the particles: of a body solid below a tenth, and most
// transparent from a quarter on; of a fixed wall, which is rarely what the picture is about, below 0.03 and
// from a tenth on. In between it fades, so that no patch of a film changes at once.
double clearness_of(double hidden, bool fixed);

}  // namespace tandem::launch
