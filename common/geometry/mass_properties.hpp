// Mass, centre of mass and inertia of homogeneous solids.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem {

struct MassProperties {
  double mass = 0;  // [kg]
  Vec3d centre;     // of mass [m]
  std::array<double, 6>
      inertia{};  // about the centre of mass: xx yy zz xy xz yz, off-diagonal elements [kg m2]
};

// Closed forms, in the frame in which the solids are defined: about the z axis, and centred at the origin.
// The height of a capsule is that of its cylinder; a truncated cone has `radius` at its lower end.
MassProperties mass_of_box(Vec3d size, double density);
MassProperties mass_of_sphere(double radius, double density);
MassProperties mass_of_cylinder(double radius, double height, double density);
MassProperties mass_of_capsule(double radius, double height, double density);
MassProperties mass_of_cone(double radius, double top_radius, double height, double density);

// Exact for a closed mesh, by signed tetrahedra [Tonon2004] about the middle of its bounding box, so that a
// mesh far from the origin loses no digits. The winding may be either way.
MassProperties mass_of_mesh(const TriangleMesh& mesh, double density);

// Volume of a closed mesh; negative where it winds inwards [m3].
double signed_volume(const TriangleMesh& mesh);

// Why a mesh encloses no volume of its own, in a sentence that names the place; empty where it does. Each
// edge has to belong to as many triangles of one direction as of the other, and closed parts inside other
// parts have to be wound the other way (cavities).
std::string why_not_solid(const TriangleMesh& mesh);

// How often a closed mesh encloses a point: 1 inside, 0 outside, -1 inside a mesh of reverse winding; a
// fraction on the surface. By solid angles [Oosterom1983].
double winding_number(const TriangleMesh& mesh, Vec3d point);
// The same of the mesh with its vertices elsewhere.
double winding_number(const TriangleMesh& mesh, const std::vector<Vec3d>& vertices, Vec3d point);

// The same solid, placed by `pose`.
MassProperties placed(const MassProperties& solid, const Pose& pose);

// All solids together, in the frame that they share.
MassProperties sum(const std::vector<MassProperties>& solids);

}  // namespace tandem
