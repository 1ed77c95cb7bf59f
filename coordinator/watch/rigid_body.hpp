// What follows from mass and inertia of a body of the scene.
#pragma once

#include "common/math/rotation.hpp"
#include "common/scene/model_joints.hpp"

namespace tandem::launch {

// Radius of gyration about the axis of the largest diagonal moment of inertia: the size of a body [m].
double gyration(const scene::Body& body);
// The inertia about the centre of mass times a vector, world axes.
Vec3d inertia_times(const scene::Body& body, const Quat& orientation, Vec3d vector);
// About the centre of mass, world axes [N m s].
Vec3d angular_momentum(const scene::Body& body, const Pose& pose, const Twist& twist);
double kinetic_energy(const scene::Body& body, const Pose& pose, const Twist& twist);  // [J]

}  // namespace tandem::launch
