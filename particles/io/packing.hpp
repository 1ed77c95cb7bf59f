// Moves spheres apart until none overlaps another one or a boundary.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "common/math/vec3.hpp"
#include "particles/base/thread_pool.hpp"
#include "particles/io/packed_spheres.hpp"

namespace tandem::particles {

// The boundary of the room. Both functions get a sphere, and are called by several threads at once.
struct PackingBounds {
  // The centre at which the sphere no longer overlaps the nearest part of the boundary; the given one where
  // it overlaps none.
  std::function<Vec3d(Vec3d centre, double radius)> moved_inside;
  std::function<bool(Vec3d centre, double radius)> overlaps;
};

struct PackingResult {
  bool is_free = false;  // of overlaps
  int sweeps = 0;
  double worst = 0;  // remaining overlap of a pair, relative to the smaller radius [-]
};

// In each sweep every sphere moves by its share of the overlaps with its neighbours, the lighter one moving
// more, and continues part of its last move; then it moves out of the boundary. All spheres are updated from
// the positions of the sweep before, so that the result does not depend on the number of threads. Dense
// starts take hundreds of sweeps; beyond a void fraction of some 0.38 of equal spheres there is no end, and
// the result says so.
PackingResult pack(PackedSpheres& spheres, const PackingBounds& bounds, int most_sweeps, ThreadPool& pool);

// Whether no moving sphere overlaps another one or the boundary.
bool is_packed(const PackedSpheres& spheres, const PackingBounds& bounds, ThreadPool& pool);

}  // namespace tandem::particles
