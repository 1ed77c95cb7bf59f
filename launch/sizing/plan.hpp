// `tandem plan`: what a scene costs on several GPUs or ranks, before anything is started.
#pragma once

#include <string>

#include "coordinator/scene/scene_file.hpp"
#include "launch/sizing/cost_model.hpp"

namespace tandem::launch {

struct PlanRequest {
  bool gpus = true;  // else ranks on cores
  unsigned count = 1;
  double spheres = 0;  // of a bed like that of the scene; 0: as many as the scene has
  double memory = 0;   // of a GPU, or of the host of the ranks [bytes]; 0: 80 GB, or that of this host
};

// Error{usage} for a scene without grains.
std::string plan(const SceneFile& file, const PlanRequest& request);

}  // namespace tandem::launch
