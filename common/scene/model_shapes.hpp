// Shapes and walls of a scene.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/ids.hpp"
#include "common/math/rotation.hpp"
#include "common/scene/model_motion.hpp"

namespace tandem::scene {

struct Box {
  Vec3d min, max;
};

struct HalfSpace {
  Vec3d point, normal;
};  // beyond the plane through `point`, on the side of the unit normal

// Particles whose centre is in it are removed.
struct Outlet {
  std::string name;
  std::variant<Box, HalfSpace> region;  // in the world
};

struct PlaneShape {
  Vec3d point, normal;
};  // solid on the side opposite to the normal
struct BoxShape {
  Vec3d size;
  std::vector<std::string> open;
};  // faces left out
// The surface about the z axis, centred; without a height endless and without ends; with segments an
// inscribed prism.
struct CylinderShape {
  double radius = 0;             // [m]
  std::optional<double> height;  // [m]
  std::optional<int> segments;
  std::vector<std::string> open;  // ends left out
};
struct SphereShape {
  double radius = 0;
};  // the surface about the origin [m]
struct MeshShape {
  std::string file;
  double scale = 1;
  Vec3d stretch{1, 1, 1};  // further factors along the axes of the file [-]
};                         // STL or OBJ, relative to the scene's folder

// Velocity of a surface along itself, such as that of a conveyor belt: the wall stays where it is. At a
// contact it is the part across the contact's normal.
struct SurfaceVelocity {
  Vec3d direction;  // in the body's frame, unit
  Motion speed;     // [m/s]
};

// About the z axis, centred; with segments an inscribed polyhedron.
struct CapsuleShape {
  double radius = 0, height = 0;  // the height is that of the cylinder [m]
  std::optional<int> segments;
};
struct ConeShape {
  double radius = 0, top_radius = 0, height = 0;  // at the lower end, at the upper end [m]
  std::optional<int> segments;
  std::vector<std::string> open = {};  // ends left out
};
// Of `points`, or of the corners in a file.
struct HullShape {
  std::vector<Vec3d> points;
  std::string file;
  double scale = 1;
};
// z over a rectangle about the origin; rows along y, in each row the heights along x.
struct HeightFieldShape {
  double size_x = 0, size_y = 0;             // [m]
  std::vector<std::vector<double>> heights;  // [m]
  std::optional<double> base;                // underside of a solid [m]; absent: a surface
};
using Geometry = std::variant<PlaneShape, BoxShape, CylinderShape, SphereShape, MeshShape, CapsuleShape,
                              ConeShape, HullShape, HeightFieldShape>;

enum class ShapeUse { wall, graphics, contact };

// A surface or a solid on a body. Every wall of dem.walls and sph.walls is one, with use `wall`.
struct Shape {
  std::string name;
  ShapeUse use = ShapeUse::wall;
  BodyId body = ground;
  std::optional<MaterialId> material;  // given for walls of grains
  int contact_material = -1;           // for use `contact`: index in BodyContact::materials
  std::optional<double> density;       // [kg/m3]; absent: that of the material
  Pose pose;                           // of the shape's frame in the body's frame (ground: in the world)
  Geometry geometry;
  std::optional<SurfaceVelocity> surface_velocity;  // of a wall of dem.walls; absent: it moves with its body
  std::string path;                                 // in the file, for messages
  bool is_of_body = false;  // one of the body's `shapes`, which a mass from shapes counts
  // Of a wall: which particles it is for. One of a body is for all that the scene has.
  bool for_grains = true, for_liquid = true;
  std::optional<Vec3d> colour = {};  // in pictures, of a wall of the ground: red, green, blue from 0 to 1
};

// What the particles know of a shape: its surface. Shapes that the particle solver has no surface for are
// walls as meshes.
struct Wall {
  std::string name;
  BodyId body = ground;  // the body it belongs to
  MaterialId material;   // for grains
  Pose pose;             // of the shape's frame in the body's frame (ground: in the world)
  std::variant<PlaneShape, BoxShape, CylinderShape, SphereShape, MeshShape> shape;
  std::string path{};                               // in the file, for messages; empty: its place in the list
  std::optional<SurfaceVelocity> surface_velocity;  // absent: the surface moves with its body
  std::optional<Vec3d> colour{};                    // in pictures
};

// What the particle solver measures: the spheres whose centre is in a region, or what the spheres do to a
// wall. Columns of sensors.csv.
struct ParticleSensor {
  std::string name;
  BodyId body = ground;  // with which the region moves
  Pose pose;             // of the shape's frame in the body's frame (ground: in the world)
  std::variant<BoxShape, CylinderShape> shape;
  std::optional<std::size_t> flow_axis;  // of the shape's frame: the direction of flow and passed
  std::string wall = {};                 // name of the wall; empty: a region, which all else is of
};

}  // namespace tandem::scene
