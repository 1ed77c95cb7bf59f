// A scene file with all files that it refers to, read once by the coordinator; the servers receive it by the
// protocol.
#pragma once

#include <optional>

#include "common/scene/model.hpp"
#include "common/scene/parameters.hpp"
#include "common/scene/shape_mass.hpp"
#include "coordinator/mesh_import/mesh_facts.hpp"
#include "coordinator/results/body_meshes.hpp"
#include "coordinator/scene/options.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

struct ImportedMesh {
  std::string wall;  // of the wall
  std::string file;  // as written in the scene
  double scale = 1;  // applied [m per unit of the file]
  MeshFacts facts;   // in the frame of the wall's shape
  Vec3d stretch{1, 1, 1};
};

// A group whose spheres were placed before the start.
struct PlacedGroup {
  std::string group;  // name
  std::string from;   // of the spheres: "packing inside drum"
  std::uint64_t spheres = 0;
  double smallest = 0, largest = 0;     // radius [m]
  double mass = 0;                      // [kg]
  std::optional<double> void_fraction;  // of the filled region; absent: of another run
};

struct SettledBed {
  double time = 0;            // simulated [s]
  double kinetic_energy = 0;  // mean of the spheres [J]
  bool from_cache = false;
};

// Where the start of particles is computed; no result depends on it.
struct SettleOn {
  std::string backend = "auto";
  unsigned threads = 0;
  bool settles = true;  // false: spheres are where they are packed, and no solver is started
  bool fills = true;    // false: the solver of the liquid is another program, which places its particles
  // Where a picture of spheres that do not settle is left; empty: nowhere.
  std::filesystem::path picture = {};
};

struct SceneFile {
  // JSON including the overrides, in the plain form (common/scene/plain_text.hpp): the servers get this
  // scene.
  std::string text;
  std::string given;  // as written, including the overrides and the values of parameters
  std::vector<scene::Parameter> parameters;
  std::string origin;                 // path of the file, for messages
  scene::Scene scene;                 // parsed and validated
  std::vector<std::string> warnings;  // problems that the user should see with the results
  std::vector<std::string> notes;     // useful information before a run
  // Of the walls with a mesh file, then of those made of facets, then of shapes of contact with a file.
  std::vector<protocol::NamedMesh> meshes;
  std::vector<ImportedMesh> mesh_facts;   // of the walls with a mesh file, in the same order
  std::vector<scene::ShapedBody> shaped;  // bodies whose mass follows from their shapes
  std::vector<BodyMesh> drawn;            // shapes with use `graphics`, by their own names
  // Of the particle groups with a file, also of those placed; and the particles of fills of the liquid.
  std::vector<protocol::NamedText> files;
  std::vector<PlacedGroup> placed;
  std::optional<SettledBed> settled;
  std::vector<std::string> log;  // of settling, of filling in a liquid, and of their cache
  // Every file and folder from which this was read, the scene first.
  std::vector<std::filesystem::path> inputs;
};

// Throws every error of the scene and of the files that it names. Places the spheres, lets them settle, and
// fills the liquid in; without `on` none of them is placed.
SceneFile read_scene(const std::filesystem::path& path, const Overrides& overrides = {},
                     const std::optional<SettleOn>& on = SettleOn{});

}  // namespace tandem::launch
