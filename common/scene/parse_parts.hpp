// The large parts of parse().
#pragma once

#include "common/scene/model.hpp"
#include "common/scene/node.hpp"
#include "common/scene/sizes.hpp"

namespace tandem::scene {

Mbd parse_mbd(const Node& node, const std::string& format);

// Without the walls. `bodies`: names of the bodies that the domain and sensors can follow.
Dem parse_dem(const Node& node, const Names& bodies);

// Without the walls. `bodies`: names of the bodies.
Sph parse_sph(const Node& node, const Names& bodies);

// Reads body, pose, shape and axis of flow of the sensor of a region.
void parse_region(const Node& node, const Names& bodies, ParticleSensor& sensor);

// A region where particles are taken out.
Outlet parse_outlet(const Node& node);

// A group of dem.particles.
ParticleGroup parse_group(const Node& node, const Names& materials);

// A function of time.
Motion parse_motion(const Node& node, const std::string& format);

// Reads dem.walls, sph.walls and the shapes of the bodies into a scene whose `mbd`, `dem` and `sph` are
// known, and makes the walls of both kinds of particles from them.
void parse_shapes(const Node& root, Scene& scene);

// The outputs of mbd.contact, where there is one.
std::vector<ContactOutput> parse_contact_outputs(const Node& mbd, const Names& bodies);

// A figure of a material or of a liquid, which the coordinator takes from the library where the scene leaves
// it out.
inline void require_figure(const Node& node, const char* key) {
  if (!node.has(key))
    node.fail(std::string("the key '") + key + "' is missing",
              std::string("add ") + key + ", or use a name of docs/materials.md, whose figures are known");
}

// Reads the pairs into a `dem` whose law is known.
void parse_pairs(const Node& node, Dem& dem);

// Reads `server` and the keys of `solver_options` of either part.
template <class Part>
void read_server(const Node& node, Part& part) {
  node.read("server", part.server);
  if (!node.has("solver_options")) return;
  for (const auto& option : node.value().at("solver_options").items())
    part.solver_options.push_back(option.key());
}

// A function of time, and the machine elements among the forces.
Motion parse_motion(const Node& node, const std::string& format);
Force parse_force(const Node& node, const Names& bodies, const Names& joints, const std::string& format);
Force parse_motor(const Node& node, const Names& joints, const std::string& format);
Force parse_cylinder(const Node& node, const Names& bodies, const std::string& format);
std::optional<ForceTable> parse_table(const Node& node, const char* key);
Limits parse_limits(const Node& node);
Friction parse_friction(const Node& node);

// Reads the name of a body or "ground"; an absent key is the ground.
BodyId read_body(const Node& node, const char* key, const Names& bodies);

// Of a body or a wall in pictures.
inline std::optional<Vec3d> read_colour(const Node& node) {
  if (!node.has("color")) return {};
  Vec3d colour;
  node.read("color", colour);
  return colour;
}

}  // namespace tandem::scene
