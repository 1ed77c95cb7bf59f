// Names of the time signals that a run of a scene records, which checks and sensors may refer to and which
// are the columns of bodies.csv and joints.csv; and names of the inputs from a controller.
#pragma once

#include <string>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::scene {

// Without "time". Contact loads only where the scene has particles, and then also for the ground.
std::vector<std::string> body_columns(const Scene& scene);

// Without "time".
std::vector<std::string> joint_columns(const Scene& scene);

// Without "time": those of bodies.csv, joints.csv, elements.csv and sensors.csv, in this order.
std::vector<std::string> all_columns(const Scene& scene);

// Inputs that actuators, motors and cylinders get from a controller: each name once, in the order of the
// forces.
std::vector<std::string> control_inputs(const Mbd& mbd);

}  // namespace tandem::scene
