// Joints that the faces of bodies allow: never certain, so that they are proposed, with a confidence.
#pragma once

#include <string>
#include <vector>

#include "launch/import/step_bodies.hpp"

namespace tandem::launch {

struct ProposedJoint {
  std::string type;                   // of the scene: revolute, cylindrical, prismatic, planar, fixed
  std::size_t parent = 0, child = 0;  // bodies
  Vec3d point, axis;                  // in the world; of a fixed joint the axis has no meaning
  double gap = 0;                     // largest of the faces' [m]
  double confidence = 0;              // from 0 to 1
  std::string reason;                 // the faces, in words
};

// By pairs of bodies: what motion all their fitting faces together allow, as if no face could lift off.
// Surest first.
std::vector<ProposedJoint> proposed_joints(const std::vector<FittingFaces>& fits, const StepBodies& bodies);

}  // namespace tandem::launch
