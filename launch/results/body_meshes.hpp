// What is drawn of each body: its walls as triangles in the body frame.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

struct BodyMesh {
  BodyId body = ground;
  std::string name;
  TriangleMesh mesh;  // body frame; ground: world [m]
};

// The ground first (when it carries walls), then all bodies in scene order. A plane is drawn where it cuts
// the domain at the start, an endless cylinder where its axis does; round walls as fine meshes. A body
// without walls is drawn as the homogeneous box that has its mass and moments of inertia.
std::vector<BodyMesh> body_meshes(const scene::Scene& scene, const std::vector<protocol::NamedMesh>& meshes);

// A wall in its body's frame, round shapes of `segments` segments. Of a plane and of an endless cylinder the
// part in the domain at the start.
TriangleMesh wall_mesh(const scene::Wall& wall, const scene::Scene& scene,
                       const std::vector<protocol::NamedMesh>& meshes, int segments);

}  // namespace tandem::launch
