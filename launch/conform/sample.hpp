// Loads and paths that the checks give to a participant, on any scene.
#pragma once

#include <vector>

#include "common/scene/model.hpp"
#include "coordinator/watch/rigid_body.hpp"
#include "protocol/messages.hpp"

namespace tandem::conform {

inline constexpr double H = 1e-3;  // length of a window of the built-in scenes [s]

// A constant load on each boundary body, which accelerates a free one by some m/s2 and rad/s2.
std::vector<protocol::BodyLoad> sample_loads(const scene::Scene& scene,
                                             const std::vector<protocol::BodyMotion>& boundary,
                                             double share = 1);

// Bodies with walls, in ascending order.
std::vector<std::uint32_t> boundary_bodies(const scene::Scene& scene);

// A path with constant velocity and angular velocity from `begin` on.
protocol::BodyMotion steady_path(std::uint32_t body, const Pose& begin, const Twist& twist, double length);
// All bodies with walls at rest in the pose of the scene.
std::vector<protocol::BodyMotion> paths_at_rest(const scene::Scene& scene);
// The pose that a body with constant velocities has after `time`.
Pose moved(const Pose& begin, const Twist& twist, double time);

const protocol::BodyLoad* load_on(const std::vector<protocol::BodyLoad>& loads, std::uint32_t body);
const protocol::BodyMotion& motion_of(const protocol::MotionSet& motion, std::uint32_t body);

// Whether two answers have the same bits. Counters of work done are left out.
bool same_bits(const protocol::MotionSet& a, const protocol::MotionSet& b);
bool same_bits(const protocol::LoadSet& a, const protocol::LoadSet& b);
bool same_bits(const protocol::BodiesFrame& a, const protocol::BodiesFrame& b);
bool same_bits(const protocol::ParticlesFrame& a, const protocol::ParticlesFrame& b);

}  // namespace tandem::conform
