// Bodies whose mass, centre of mass and inertia follow from their shapes.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/mass_properties.hpp"
#include "common/scene/model.hpp"

namespace tandem::scene {

struct ShapedBody {
  BodyId body;
  std::size_t shapes = 0;  // that have a mass
  MassProperties mass;     // in the frame of the body as it is written
};

// Gives the bodies with a mass from shapes their mass and inertia, and moves their origin to the centre of
// mass: the pose of the body, and of the shapes and walls on it, change accordingly. `in_files`: the
// triangles of each shape with a file, in the order of scene.shapes. Throws Error{scene} where a shape
// encloses no volume. `warnings` gets shapes that overlap, because their mass counts twice.
std::vector<ShapedBody> take_mass_from_shapes(Scene& scene, const std::vector<TriangleMesh>& in_files,
                                              const std::string& origin, std::vector<std::string>& warnings);

// Of a shape with a density of its own or a material; 0 otherwise [kg/m3].
double density_of(const Shape& shape, const Scene& scene);

}  // namespace tandem::scene
