// What spheres do to walls, summed over a window: on each triangle of the walls whose frames have fields, and
// on each wall that has a sensor. The sums are integers, so that they have the same bits for every number of
// threads and back end.
//
// Only the generic variant has them: the branch would make the micro steps of the others longer.
#pragma once

#include <cstdint>

#include "common/math/vec3.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/fixed_point.hpp"

namespace tandem::dem {

enum WallSum : std::uint32_t {
  wall_force_x,  // of the spheres on the wall, axes of the world [N]
  wall_force_y,
  wall_force_z,
  wall_normal,         // of the normal forces, positive where they push [N]
  wall_shear,          // of the sizes of the tangential forces [N]
  wall_friction_work,  // of sliding friction [J]
  wall_wear,           // of the wear coefficient times normal force times sliding distance [J]
  wall_sum_count,
};
inline constexpr std::uint32_t no_wall_row = ~0u;

// The rows of the sums that contacts with one facet are added to.
struct WallRows {
  std::uint32_t of_wall = no_wall_row, of_facet = no_wall_row;
};

struct WallSumsView {
  const WallRows* rows = nullptr;  // of each facet; null: nothing is summed
  std::int64_t* sum = nullptr;  // of the micro steps of this window so far, in quanta (rows x wall_sum_count)
  Quantum force, work;          // [N] [J]

  TANDEM_HD bool any() const { return rows != nullptr; }
};

// What one contact adds in one micro step.
struct WallContribution {
  Vec3d force;  // on the wall [N]
  double normal = 0, shear = 0, friction_work = 0, wear = 0;
};

TANDEM_HD inline void add_to_walls(const WallSumsView& view, std::uint32_t facet, const WallContribution& c) {
  const WallRows rows = view.rows[facet];
  const std::int64_t add[wall_sum_count] = {
      to_fixed(c.force.x, view.force), to_fixed(c.force.y, view.force), to_fixed(c.force.z, view.force),
      to_fixed(c.normal, view.force),  to_fixed(c.shear, view.force),   to_fixed(c.friction_work, view.work),
      to_fixed(c.wear, view.work)};
  const std::uint32_t both[] = {rows.of_wall, rows.of_facet};
  for (const std::uint32_t row : both) {
    if (row == no_wall_row) continue;
    for (std::uint32_t k = 0; k < wall_sum_count; ++k)
      if (add[k] != 0) add_shared(view.sum + std::size_t{row} * wall_sum_count + k, add[k]);
  }
}

// Adds the sums of a window to those since the start, for entry i of the sums.
struct CloseWallSums {
  const std::int64_t* window;
  double* since_start;  // [N s] [J]
  Quantum force, work;
  double dt;  // micro step [s]

  TANDEM_HD void operator()(std::uint32_t i) const {
    const bool is_work = i % wall_sum_count >= wall_friction_work;
    since_start[i] += is_work ? from_fixed(window[i], work) : dt * from_fixed(window[i], force);
  }
};

}  // namespace tandem::dem
