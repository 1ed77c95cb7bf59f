// The liquid of a scene before the first step: its properties, its walls, and its particles.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "protocol/messages.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "sph_server/io/body_walls.hpp"
#include "sph_server/io/fill.hpp"
#include "sph_server/io/inlets.hpp"
#include "sph_server/io/rest_loads.hpp"

namespace tandem::sph {

struct LiquidStart {
  LiquidSetup setup;
  std::vector<BodyWalls> walls;  // of setup.walls, which end with the pistons of the inlets
  std::vector<Inlet> inlets;
  std::vector<particles::BodyPose> poses;  // of setup.walls
  Sites sites;                             // of the boxes
  std::vector<FilledInside> insides;
  double depth = 0;                    // of the deepest liquid [m]
  BodyId vessel = ground;              // see vessel_of()
  Vec3d velocity;                      // of the liquid [m/s]
  std::vector<std::string> coarsened;  // see wall_meshes()
  std::vector<std::string> warnings;   // of open faces, edges, inlets, and of a unit that is likely wrong

  std::size_t particles() const;  // about as many as there will be
};
// Error{scene} for a speed of sound that is too low for the liquid as it starts, and for walls and amounts
// that check_start() and insides_of() refuse. `meshes`: of the walls with a mesh, by name.
LiquidStart prepare_start(const scene::Scene& scene, const std::vector<NamedMesh>& meshes);

// The places of fills that were computed before, among the files of a configuration.
PlacesByFill places_in(const std::vector<protocol::NamedText>& files);

// Its particles. Error{scene} as liquid_at_start() and refuse_coinciding_walls().
LiquidState particles_of(const LiquidStart& start, const scene::Scene& scene,
                         const PlacesByFill& places = {});

// Loads of the liquid of a scene at rest, see loads_at_rest(). `places`: those of place_of_fill().
std::map<BodyId, Wrench> rest_loads_of(const scene::Scene& scene, const std::vector<NamedMesh>& meshes,
                                       const PlacesByFill& places);

// Moves the walls to the poses at which a machine starts in equilibrium, by body, and the liquid with its
// vessel. Returns a warning where that tilts the surface. Error{scene} where another wall beside the liquid
// moves relative to the vessel.
std::optional<std::string> move_to(const std::map<std::uint32_t, Pose>& poses, const scene::Scene& scene,
                                   LiquidStart& start, LiquidState& liquid);

inline LiquidState start_of_liquid(const scene::Scene& scene, const std::vector<NamedMesh>& meshes,
                                   const PlacesByFill& places = {}) {
  return particles_of(prepare_start(scene, meshes), scene, places);
}

}  // namespace tandem::sph
