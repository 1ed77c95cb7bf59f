// `tandem import` of a STEP file.
#pragma once

#include "launch/import/import.hpp"
#include "launch/import/proposed_joints.hpp"

namespace tandem::launch {

// What the scene is made from, for tables.
struct StepImport {
  StepFile step;
  StepBodies bodies;
  std::vector<ProposedJoint> joints;
};

// Bodies, with meshes as graphics, or as walls with --into; joints with --joints.
Imported import_step(const ImportOptions& options);

// Tree of the parts with their bodies and masses, and the proposed joints.
std::string step_tables(const StepImport& import, const ImportOptions& options);

}  // namespace tandem::launch
