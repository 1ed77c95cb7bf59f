// What the coordinator tells a solver of the start besides the scene, as texts among the files of its
// configuration: where a machine starts in equilibrium with a liquid.
#pragma once

#include <map>
#include <string_view>
#include <vector>

#include "protocol/messages.hpp"

namespace tandem::protocol {

// To the multibody side: loads of the liquid at rest, about the centres of mass, by body.
inline constexpr std::string_view start_loads_file = "start_loads";
// To the solver of the liquid: poses of the bodies at the start, by body.
inline constexpr std::string_view start_poses_file = "start_poses";

NamedText text_of_start_loads(const std::map<std::uint32_t, Wrench>& loads);
NamedText text_of_start_poses(const std::vector<BodyMotion>& boundary);

// Empty where the files have none. Error{protocol} for a text that is damaged.
std::map<std::uint32_t, Wrench> start_loads(const std::vector<NamedText>& files);
std::map<std::uint32_t, Pose> start_poses(const std::vector<NamedText>& files);

}  // namespace tandem::protocol
