// Values reported by the solvers, in the order of the columns of common/scene/columns.hpp.
#pragma once

#include <vector>

#include "common/scene/model.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

// Appends the values of scene::body_columns(). `bodies` is null without a multibody part, `loads` without
// particles.
void add_body_values(const scene::Scene& scene, const protocol::BodiesFrame* bodies,
                     const protocol::LoadSet* loads, std::vector<double>& row);
// Appends the values of scene::joint_columns().
void add_joint_values(const protocol::BodiesFrame& bodies, std::vector<double>& row);

}  // namespace tandem::launch
