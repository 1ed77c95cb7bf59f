// Contact between bodies.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/scene/model_shapes.hpp"

namespace tandem::scene {

// Of a surface that bodies touch with. It has a stiffness, for all shapes, or Young's modulus and Poisson's
// ratio, for spheres by Hertz's law.
struct ContactMaterial {
  std::string name;
  std::optional<double> stiffness;  // of one point of contact [N/m]
  double young = 0, poisson = 0;    // [Pa], [-]
  double restitution = 1;           // [-], at least 0.01
  double friction = 0;              // Coulomb coefficient [-]
  double rolling_friction = 0;      // largest rolling moment over R* N, as dem.materials has it [-]
};

// Values of a contact between two materials, in either order, in place of those that follow from the two.
struct ContactMaterialPair {
  int a = 0, b = 0;  // indices of the materials
  std::optional<double> stiffness, restitution, friction, rolling_friction;
};

// A body or the ground with all of its shapes of contact, or one of these shapes.
struct ContactSide {
  BodyId body = ground;
  std::string shape;  // empty: all of them
};

// Forces of contacts that are results: what `from` does to `on` (common/scene/element_columns.hpp).
struct ContactOutput {
  std::string name;
  std::vector<ContactSide> on;    // one or more; torques are about the first one's centre of mass
  std::vector<ContactSide> from;  // empty: all that is not `on`
};

enum class Impacts {
  resolved,      // steps end where contacts begin and end, and an impact takes many of them
  within_steps,  // contacts begin and end within steps, which are as long as without them
  time_stepping  // no impact is resolved: a step of fixed length is the minimum of a convex function
};

struct BodyContact {
  Impacts impacts = Impacts::resolved;  // of shapes that are no meshes
  std::vector<ContactMaterial> materials;
  std::vector<ContactMaterialPair> pairs;
  std::vector<Shape> ground;                  // shapes fixed to the ground
  std::vector<std::array<BodyId, 2>> ignore;  // bodies that pass through each other
  std::vector<ContactOutput> outputs;
};

// Whether a shape of contact belongs to the side.
inline bool is_of(const Shape& shape, const ContactSide& side) {
  return shape.body == side.body && (side.shape.empty() || shape.name == side.shape);
}
// Whether a contact of these two shapes is computed, in either order.
bool contact_is_computed(const Geometry& a, const Geometry& b);
// Values of a pair of materials: the given ones; else a geometric mean of restitution and friction, and a
// harmonic mean of the stiffness, where both materials have one.
ContactMaterialPair combined(const BodyContact& contact, int a, int b);

}  // namespace tandem::scene
