// What a sphere that ends a run did before, for the error message.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "dem_server/engine/engine.hpp"
#include "dem_server/geometry/path.hpp"
#include "dem_server/geometry/surface.hpp"
#include "protocol/messages.hpp"

namespace tandem::dem {

// Where it was a micro step before, how it moved, and its deepest contacts. `poses` are those of the bodies
// then, one per body.
std::string history(const SphereError& error, const Surface& surface, std::span<const BodyPose> poses,
                    const scene::Scene& scene);

std::optional<Vec3d> position_in(const protocol::ParticlesFrame& frame, std::uint32_t id);  // [m]

}  // namespace tandem::dem
