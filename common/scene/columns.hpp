// The time signals that a run of a scene records, by name: what checks and sensors may ask for, and what
// bodies.csv and joints.csv hold; and those that it takes from a controller.
#pragma once

#include <string>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::scene {

// Without "time". Contact loads only where the scene has particles; the ground then has them too.
std::vector<std::string> body_columns(const Scene& scene);

// Without "time".
std::vector<std::string> joint_columns(const Scene& scene);

// What actuators take from a controller: each name once, in the order of the forces.
std::vector<std::string> control_inputs(const Mbd& mbd);

}  // namespace tandem::scene
