// Triangle meshes of solids, closed unless faces are left out, and wound counter-clockwise as seen from
// outside.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem {

// Truncated cone about the z axis, inscribed with `segments` sides, centred at half its height: `radius` at
// the lower end, `top_radius` at the upper one, where 0 is an apex. The ends in `open`, "+z" and "-z", are
// left out.
TriangleMesh cone_mesh(double radius, double top_radius, double height, int segments,
                       const std::vector<std::string>& open = {});

// Capsule about the z axis, centred at the origin: a cylinder of `height` with a hemisphere of `radius` at
// each end, inscribed with `segments` meridians and as many zones, at least 4, as give an angle of 2 pi /
// segments or less.
TriangleMesh capsule_mesh(double radius, double height, int segments);

// Surface z = heights[row][column] over a rectangle about the origin, x growing with the column and y with
// the row; the four corners of a cell make two triangles, which meet in the diagonal from its lowest to its
// highest row and column. With `base` the solid between the surface and the plane z = base, otherwise the
// surface only.
TriangleMesh height_field_mesh(double size_x, double size_y, const std::vector<std::vector<double>>& heights,
                               std::optional<double> base = {});

}  // namespace tandem
