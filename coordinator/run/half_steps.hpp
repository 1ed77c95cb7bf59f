// The second run of `--estimate richardson`: the same scene with half the step of the multibody part;
// comparing the two gives the error of the first (mbd_server/coupling/error_estimate.hpp).
#pragma once

#include "coordinator/scene/options.hpp"
#include "coordinator/scene/scene_file.hpp"

namespace tandem::launch {

// Throws Error{usage} where such a run is not possible.
void expect_repeatable(const RunOptions& options, const scene::Scene& scene, bool controller_in_program);

// With windows of equal length every step is halved. With error control the longest step is halved and the
// tolerance divided by sixteen, so that all steps are at most half as long: local errors of the position, and
// those of the velocity times the longest step, are proportional to h^3. The frames have no spheres.
SceneFile with_half_steps(const SceneFile& file);

// The folder is "half_steps" in the folder of the first run.
RunOptions for_half_steps(const RunOptions& options);

}  // namespace tandem::launch
