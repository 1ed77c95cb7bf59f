// What a window's progress is steered by: one record that lives beside the particles, on the device if they
// are. The host writes it at a window's begin and reads it at the end; in between only close_step() changes
// it, so that the decision to rebuild the neighbour list costs no round trip.
#pragma once

#include <cmath>
#include <cstdint>

#include "common/host_device.hpp"

namespace tandem::dem {

enum ControlError : std::uint32_t {
  not_finite = 1u << 0,              // a sphere's velocity is no number, or beyond the speed limit
  list_overflow = 1u << 1,           // neighbour list longer than its memory
  wall_list_overflow = 1u << 2,      // wall list longer than its memory
  wall_contacts_overflow = 1u << 3,  // one sphere touches more surfaces of one body than can be told apart
  force_range = 1u << 4,             // a wall force beyond the range of the exact sums
};

struct Control {
  std::uint32_t step = 0;   // micro steps done in this window
  std::uint32_t steps = 0;  // micro steps in this window
  std::uint32_t stamp = 2;  // micro steps since the start of the run, modulo 2^32, for contact histories
  std::uint32_t rebuild_due = 1;  // the list must be built before the next step
  std::uint32_t state_side = 0;   // which half of the double-buffered state is current
  std::uint32_t list_side = 0;    // which half of the double-buffered lists is current
  std::uint32_t error = 0;        // ControlError bits
  std::uint32_t error_particle =
      ~0u;                         // lowest id of a sphere that raised not_finite or wall_contacts_overflow
  std::uint32_t open = 0;          // a micro step is being done
  std::uint32_t blocks_done = 0;   // used by the GPU loop only
  std::uint32_t near_spheres = 0;  // spheres near walls
  float max_speed2 = 0;            // largest squared speed since the list was built [m2/s2]
  float max_overlap_ratio = 0;     // since the start [-]
  double dt = 0;                   // micro step [s]
  double skin = 0;                 // of the list [m]
  double body_speed = 0;           // bound of the speed of any wall point in this window [m/s]
  double travel = 0;               // bound of the approach of two spheres since the list was built [m]
  double wall_travel = 0;          // bound of the approach of a sphere and a wall since then [m]
  std::uint64_t rebuilds = 0;
  std::uint64_t lost = 0;
  std::uint64_t list_entries = 0, wall_entries = 0;  // used by the current lists

  TANDEM_HD bool halted() const { return step >= steps || rebuild_due != 0 || error != 0; }
};

// Copies what opening and closing a step changes, and leaves alone what a step's threads report.
TANDEM_HD inline void store_progress(const Control& from, Control& to) {
  to.step = from.step;
  to.stamp = from.stamp;
  to.rebuild_due = from.rebuild_due;
  to.state_side = from.state_side;
  to.open = from.open;
  to.travel = from.travel;
  to.wall_travel = from.wall_travel;
}

// Ends the micro step that is open: the list stays valid while no two spheres can have closed the skin
// between them. The largest speed since the list was built bounds that of this step; a running maximum costs
// a GPU no atomic where it does not grow.
TANDEM_HD inline void close_step(Control& c) {
  if (c.open == 0) return;
  c.open = 0;
  const double moved = std::sqrt(static_cast<double>(c.max_speed2)) * c.dt;
  c.travel += 2 * moved;
  c.wall_travel += moved + c.body_speed * c.dt;
  c.rebuild_due = c.travel > c.skin || c.wall_travel > c.skin;
  c.state_side ^= 1;
  ++c.stamp;
  ++c.step;
}

// Begins a micro step, unless there is something else to do first.
TANDEM_HD inline void open_step(Control& c) {
  close_step(c);
  c.open = c.halted() ? 0 : 1;
}

}  // namespace tandem::dem
