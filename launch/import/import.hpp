// `tandem import`: a URDF model becomes a scene.
//
// Links with mass become bodies whose axes are those of the link and whose origin is the centre of mass. A
// link without <inertial> is a frame of the link that it is fixed to. The root is fixed to the ground unless
// it is free. A joint that mimics another is coupled with it. Collision shapes become walls, which a scene
// has beside particles only: they are imported into a scene that has these. Whatever a scene cannot say is
// told in a note.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace tandem::launch {

// URDF limits the travel of a joint, but does not say how stiff its stops are.
struct StopStiffness {
  double angular = 0;  // [N m/rad]
  double linear = 0;   // [N/m]
};

struct ImportOptions {
  std::filesystem::path model;   // URDF
  std::filesystem::path output;  // scene; empty: standard output
  std::filesystem::path into;    // scene with the particles, its `mbd` is replaced; empty: none
  std::string material;          // of the walls, a name of that scene
  bool free_root = false;
  std::optional<StopStiffness> stops;  // of joints with limits; absent: limits are told
};

struct Imported {
  nlohmann::ordered_json scene;
  std::vector<std::string> notes;  // what was not taken over, and why
};

// Error{scene} names the link or joint. The scene has passed the checks of `tandem validate`.
Imported import_urdf(const ImportOptions& options);

// Writes the scene, and the notes to standard error.
void import_model(const ImportOptions& options);

}  // namespace tandem::launch
