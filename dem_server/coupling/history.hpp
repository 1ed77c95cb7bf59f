// The state and the contacts of a sphere before it ended a run, for the error message.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "dem_server/engine/engine.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/geometry/path.hpp"
#include "particles/geometry/surface.hpp"
#include "protocol/messages.hpp"

namespace tandem::dem {

// Position, motion and deepest contacts of the sphere one micro step before the error. `poses` are those of
// the bodies at that time, one per body.
std::string history(const SphereError& error, const Surface& surface, std::span<const BodyPose> poses,
                    const scene::Scene& scene);

std::optional<Vec3d> position_in(const protocol::ParticlesFrame& frame, std::uint32_t id);  // [m]

}  // namespace tandem::dem
