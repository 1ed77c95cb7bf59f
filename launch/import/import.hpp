// `tandem import`: converts a URDF model to a scene.
//
// Links with mass become bodies with the axes of the link and their origin at the centre of mass. A link
// without <inertial> is a frame of the link that it is fixed to. The root is fixed to the ground unless it is
// free. A joint with <mimic> is coupled with the other joint. Collision shapes become walls; as a scene has
// walls only together with particles, they are imported into a scene that has particles. A note reports
// everything that a scene cannot represent.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace tandem::launch {

// URDF limits the travel of a joint, but does not give the stiffness of its stops.
struct StopStiffness {
  double angular = 0;  // [N m/rad]
  double linear = 0;   // [N/m]
};

struct ImportOptions {
  std::filesystem::path model;   // URDF
  std::filesystem::path output;  // scene; empty: standard output
  std::filesystem::path into;    // scene with the particles, whose `mbd` is replaced; empty: none
  std::string material;          // of the walls, a material of that scene
  bool replace = false;          // whether a file that is there is replaced
  bool free_root = false;
  std::optional<StopStiffness> stops;  // for joints with limits; absent: a note reports the limits
};

struct Imported {
  nlohmann::ordered_json scene;
  std::vector<std::string> notes;  // what was not imported, and why
};

// Throws Error{scene} that names the link or joint. The scene has passed the checks of `tandem validate`.
Imported import_urdf(const ImportOptions& options);

// Writes the scene, and the notes to standard error. Throws Error{usage} where the file is there and is not
// to be replaced: people go on writing in an imported scene, so that an earlier import is not replaced
// either.
void import_model(const ImportOptions& options);

}  // namespace tandem::launch
