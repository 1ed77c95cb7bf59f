// The surfaces drawn for each body: its walls and shapes as triangles in the body frame.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

inline constexpr int round_segments = 64;  // of round walls, for display
// Of the ground's shapes of contact. Names of bodies have no dot.
inline constexpr const char* contact_ground = "ground.contact";
// Of a wall of the ground that has a colour: this, and its name.
inline const std::string coloured_wall = "ground.wall.";

struct BodyMesh {
  BodyId body = ground;
  std::string name;
  TriangleMesh mesh;  // body frame; ground: world [m]
};

// The walls of the ground, those with a colour as surfaces for themselves (as `coloured_wall` NAME), then its
// shapes of contact (as `contact_ground`), each where there are any, then all bodies in the order of the
// scene. A plane is drawn where it intersects the domain at the start, an endless cylinder where its axis
// does; round walls are fine meshes. `shapes` are those that are no walls, by their own names; the ground's
// are shapes of contact. A body without either is drawn as the homogeneous box with its mass and moments of
// inertia. A plane of the ground's contact is drawn where it intersects the domain of the particles and
// everything else; without particles it is a rectangle below everything else, larger by a quarter of that on
// each side, and none where it is farther away than ten times the size of everything else. One that is a wall
// of the ground as well is drawn a little below the wall.
std::vector<BodyMesh> body_meshes(const scene::Scene& scene, const std::vector<protocol::NamedMesh>& meshes,
                                  const std::vector<BodyMesh>& shapes = {});

// A wall in its body's frame, round shapes with `segments` segments. For a plane and an endless cylinder, the
// part in the domain at the start.
TriangleMesh wall_mesh(const scene::Wall& wall, const scene::Scene& scene,
                       const std::vector<protocol::NamedMesh>& meshes, int segments);

}  // namespace tandem::launch
