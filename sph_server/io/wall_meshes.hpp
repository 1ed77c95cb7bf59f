// Flat faces for surfaces that are round, or finer than the liquid feels.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"

namespace tandem::sph {

// How far walls may be from the surfaces that they stand for [m].
inline double deviation_of(const scene::Sph& sph) {
  return sph.wall_deviation * sph.spacing;
}

// A round shape as flat faces that enclose its volume, so that they are partly outside and partly inside.
struct FacetedShape {
  TriangleMesh mesh;     // in the frame of the shape
  int segments = 0;      // around
  double deviation = 0;  // from the round surface [m]
};
// open: see cylinder_mesh(). A cylinder with `segments` is that prism.
FacetedShape faceted(const scene::CylinderShape& cylinder, const std::vector<std::string>& open,
                     double deviation);
FacetedShape faceted(const scene::SphereShape& sphere, double deviation);

// The meshes of the liquid's walls, with as few triangles as deviation_of() leaves. Adds a sentence for each
// mesh that has fewer now.
std::vector<NamedMesh> wall_meshes(const scene::Sph& sph, const std::vector<NamedMesh>& given,
                                   std::vector<std::string>& sentences);

}  // namespace tandem::sph
