// The second run of `--estimate richardson`: the same scene with steps of the multibody part half as long,
// from which the error of the first one follows (mbd_server/coupling/error_estimate.hpp).
#pragma once

#include "launch/coordinator/options.hpp"
#include "launch/coordinator/scene_file.hpp"

namespace tandem::launch {

// Error{usage} where there is no such run.
void expect_repeatable(const RunOptions& options, const scene::Scene& scene, bool controller_in_program);

// With windows of one length every step is cut into two; with error control the longest step is half as long
// and the tolerance a sixteenth, by which all steps are at most half as long (local errors of the position
// are as h^3, those of the velocity, times the longest step, as well). The frames have no spheres.
SceneFile with_half_steps(const SceneFile& file);

// In the folder "half_steps" of the first one.
RunOptions for_half_steps(const RunOptions& options);

}  // namespace tandem::launch
