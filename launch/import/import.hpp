// `tandem import`: converts a model to a scene.
//
// Of URDF, links with mass become bodies with the axes of the link and their origin at the centre of mass. A
// link without <inertial> is a frame of the link that it is fixed to. The root is fixed to the ground unless
// it is free. A joint with <mimic> is coupled with the other joint. Collision shapes become walls; as a scene
// has walls only together with particles, they are imported into a scene that has particles. A note reports
// everything that a scene cannot represent.
//
// Of STEP, parts become bodies with mass by their exact volume; joints are proposed
// (launch/import/step_scene.hpp).
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

// URDF limits the travel of a joint, but does not give the stiffness of its stops.
struct StopStiffness {
  double angular = 0;  // [N m/rad]
  double linear = 0;   // [N/m]
};

struct ImportOptions {
  std::filesystem::path model;   // URDF or STEP
  std::filesystem::path output;  // scene; empty: standard output
  std::filesystem::path into;    // scene with the particles, whose `mbd` is replaced; empty: none
  // URDF: one name, of the walls, of that scene. STEP: "PATTERN=NAME" of parts, of that scene or of the
  // library.
  std::vector<std::string> materials;
  bool replace = false;  // whether a file that is there is replaced
  bool free_root = false;
  std::optional<StopStiffness> stops;  // for joints with limits; absent: a note reports the limits
  // STEP: of the parts that a pattern matches (docs/cad_import.md).
  std::vector<std::string> densities;  // "PATTERN=VALUE" [kg/m3]
  std::vector<std::string> merge, ground;
  double fuse_smaller_than = 0;     // diagonal of the part [m]; 0: none
  std::optional<double> deviation;  // of the meshes [m]; absent: 1/1000 of the part's diagonal
  bool joints = false;              // those proposed with at least this confidence are written
  double least_confidence = 0.5;
  std::map<std::string, double> scene_densities;  // of the materials of `into`; filled by the import [kg/m3]
};

struct Imported {
  nlohmann::ordered_json scene;
  // Of URDF: what was not imported, and why. Of STEP: whole lines, of what was not imported or is renamed.
  std::vector<std::string> notes;
  struct MeshFile {
    std::filesystem::path file;
    TriangleMesh mesh;
  };
  std::vector<MeshFile> files;  // to be written as STL
  std::string tables;           // for the user
};

// Throws Error{scene} that names the link or joint. The scene has passed the checks of `tandem validate`.
Imported import_urdf(const ImportOptions& options);

// Writes the scene and its meshes, the tables to standard output, and the notes to standard error. Throws
// Error{usage} where the file is there and is not to be replaced: people go on writing in an imported scene,
// so that an earlier import is not replaced either.
void import_model(const ImportOptions& options);

}  // namespace tandem::launch
