// Triangles of walls and regions, for what is inside of them.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/math/rotation.hpp"
#include "common/scene/model.hpp"

namespace tandem::particles {

// A frame whose z axis points against gravity. Its origin and its other axes are those of the wall for a
// region inside a wall, so that a scene that is rotated as a whole gets the same packing; otherwise those of
// the world.
struct GravityFrame {
  Vec3d origin;
  Mat3d to_world;  // columns are the axes of the frame
  Vec3d world(Vec3d p) const { return origin + to_world * p; }
  Vec3d local(Vec3d p) const { return to_world.transpose_times(p - origin); }
};

}  // namespace tandem::particles

namespace tandem::particles::room {

// The closed surface of a wall in its own frame: open faces are closed. Empty for a plane and for a cylinder
// without a height.
TriangleMesh closed_mesh(const scene::Wall& wall, const std::vector<NamedMesh>& meshes);
// The same with its open faces left out.
TriangleMesh surface_mesh(const scene::Wall& wall, const std::vector<NamedMesh>& meshes);
bool has_open_faces(const scene::Wall& wall);

Pose pose_of(const scene::Wall& wall, const scene::Scene& scene);
const scene::Wall& wall_named(const scene::Scene& scene, const std::string& name);
GravityFrame frame_of(const scene::Scene& scene, const Pose& container);
TriangleMesh placed(TriangleMesh mesh, const Pose& pose, const GravityFrame& frame);

// With the openings closed from which the surface rises all around, as from the mouth of a funnel, by
// triangles about their middle. In the gravity frame.
TriangleMesh with_closed_mouths(const TriangleMesh& given);

// The convex hull of walls, in the gravity frame. Error{scene} at `where` for one that is endless, and where
// all lie in one plane.
TriangleMesh hull_of(const std::vector<std::string>& names, const scene::Scene& scene,
                     const std::vector<NamedMesh>& meshes, const GravityFrame& frame,
                     const std::string& where);

// Box or cylinder of the world in the gravity frame.
TriangleMesh region_mesh(const decltype(scene::PackingFill::region)& region, const GravityFrame& frame);

}  // namespace tandem::particles::room
