// Walls that are not made of triangles.
#pragma once

#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "particles/geometry/facet.hpp"

namespace tandem::particles {

// True for planes, spheres, and cylinders without `segments`. Boxes are not among them, because triangles
// represent their flat faces exactly.
bool is_analytic(const decltype(scene::Wall::shape)& shape);

// The facets of such a wall in its body's frame; a closed cylinder has a side and two discs. Error{scene} for
// a plane whose normal has no length; `where` names the wall.
std::vector<Facet> analytic_facets(const scene::Wall& wall, const std::string& where);

// The surface of a sphere about `centre`.
Facet ball_facet(Vec3d centre, double radius);

// Radius to which overlaps of the facet and a sphere of this radius are related: that of a ball facet may be
// smaller [m].
double smaller_radius(const Facet& facet, double radius);

// Bound of the distance of the facet's points from the body's origin; infinite for unbounded facets [m].
double extent_of(const Facet& analytic);

}  // namespace tandem::particles
