// Joints of a URDF model as joints and couplers of a scene.
#pragma once

#include <optional>
#include <vector>

#include "launch/import/bodies.hpp"
#include "launch/import/import.hpp"

namespace tandem::launch {

struct JointOptions {
  bool free_root = false;
  std::optional<StopStiffness> stops;  // absent: a note reports the limits
};

// Both functions add a note for everything that a scene cannot represent.
nlohmann::ordered_json joints_of(const urdf::ModelInterface& model, const LinkFrames& frames,
                                 const JointOptions& options, const std::string& file,
                                 std::vector<std::string>& notes);
// <mimic> couples two joint coordinates, as a coupler of the scene does.
nlohmann::ordered_json couplers_of(const urdf::ModelInterface& model, const LinkFrames& frames,
                                   const std::string& file, std::vector<std::string>& notes);

}  // namespace tandem::launch
