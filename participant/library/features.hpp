// Names for what a scene asks of a solver, so that a solver can state what it knows and a scene with anything
// else is refused by name.
#pragma once

#include <string>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::participant {

struct Feature {
  std::string name;   // "joint:revolute"
  std::string where;  // "mbd.joints 'hinge'"
};

// What a multibody solver has to know, each feature once, with the first place that asks for it.
std::vector<Feature> features_of_mbd(const scene::Scene& scene);
// What a particle solver has to know beyond spheres at given places, flat walls of triangles and the ground.
// `spinning_group`: name of the first group with a sphere that rotates at the start; may be empty.
std::vector<Feature> features_of_dem(const scene::Scene& scene, const std::string& spinning_group);
// What a solver of a liquid has to know beyond one liquid in boxes.
std::vector<Feature> features_of_sph(const scene::Scene& scene);

// Throws Error{scene} for the features that are not in `known`, in which "joint:*" stands for all that begin
// with "joint:".
void expect_known(const std::vector<Feature>& features, const std::vector<std::string>& known,
                  const std::string& program);

}  // namespace tandem::participant
