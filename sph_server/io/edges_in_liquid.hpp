// Walls with sharp edges that stick out into the liquid, on which its load swings.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "particles/geometry/path.hpp"
#include "sph_server/io/body_walls.hpp"
#include "sph_server/io/fill.hpp"

namespace tandem::sph {

// A closed wall with fewer spacings across is not trusted where it has a sharp edge in the liquid.
inline constexpr double enough_across = 12;

// Part of the mean load on a body of so many spacings across that may be missing [%]: what was measured with
// 4 to 8 spacings, rounded up; at most 100 (docs/experiments/2026-11-sph-rims.md).
double missing_percent(double across);

// A sentence for each closed wall that is too narrow, of the least extent along the axes of its frame, and
// has a sharp convex edge in the liquid at the start. Edges that the liquid reaches later and those of open
// walls, such as sheets, are not among them. poses: of the walls.
std::vector<std::string> edges_in_liquid(const scene::Scene& scene, const std::vector<BodyWalls>& walls,
                                         std::span<const particles::BodyPose> poses,
                                         const std::vector<FilledInside>& insides);

}  // namespace tandem::sph
