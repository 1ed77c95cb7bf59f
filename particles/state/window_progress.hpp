// Progress within a window: one record that is stored next to the particles, on the device if they are there.
// The host writes it at the begin of a window and reads it at the end. In between, the processor of the
// particles alone decides when the neighbour lists are rebuilt, so that this decision costs no round trip.
#pragma once

#include <cmath>
#include <cstdint>

#include "common/math/vec3.hpp"
#include "particles/grid/skin.hpp"

namespace tandem::particles {

enum StepError : std::uint32_t {
  not_finite = 1u << 0,              // a sphere's velocity is not finite, or above the speed limit
  list_overflow = 1u << 1,           // a list, or what a rebuild carries over, exceeds its memory
  wall_contacts_overflow = 1u << 2,  // one sphere is in contact with too many surfaces of one body
  force_range = 1u << 3,             // a wall force beyond the range of the exact sums
  // A region of dem_server/backend/cuda/resident/resident.cuh does not fit: continue without regions
  region_overflow = 1u << 4,
  blocks_apart = 1u << 5,  // a grid barrier of dem_server/backend/cuda/resident/resident.cuh timed out
  ranks_apart = 1u << 6,   // another rank sent no message for long
};

inline constexpr std::uint32_t of_rebuilds = list_overflow | region_overflow;

// A sphere and its error as one number that is lower for graver errors. Of several errors in one step the
// gravest is reported, and among the spheres that raised it the one with the lowest id.
inline constexpr std::uint32_t most_culprits = 1u << 30;  // number of distinct ids
TANDEM_HD inline std::uint32_t culprit(StepError what, std::uint32_t id) {
  return (what == not_finite ? 0u : what == wall_contacts_overflow ? 1u : 2u) * most_culprits + id;
}
inline std::uint32_t id_of_culprit(std::uint32_t culprit) {
  return culprit % most_culprits;
}

// What changes from step to step.
struct StepProgress {
  std::uint32_t step = 0;   // micro steps done in this window
  std::uint32_t stamp = 2;  // micro steps since the start of the run, modulo 2^32, for contact histories
  std::uint32_t rebuild_due = 1;  // the list must be built before the next step
  std::uint32_t state_side = 0;   // which half of the double-buffered state is current
  std::uint32_t open = 0;         // a micro step is in progress
  std::uint32_t failed = 0;       // an earlier step has reported an error
  float max_speed2 = 0;           // largest squared speed since the list was built [m2/s2]
  float top_speed2 = 0;           // largest max_speed2 in this window [m2/s2]
  std::uint32_t age = 0;          // micro steps since the list was built
  double travel = 0;              // bound of the approach of two spheres since the list was built [m]
  double wall_travel = 0;         // bound of the approach of a sphere and a wall since then [m]
};

// Progress is double buffered like the state. Each kernel of a step derives the present progress from the
// side that the step before has left, which no kernel writes meanwhile, and the step writes the other side.
// No kernel therefore waits for the bookkeeping of another one. The side of a step is the parity of its
// number in a round of steps; a round has an even number of steps, and side 0 is current between rounds. The
// CPU uses side 0 only.
struct WindowProgress {
  StepProgress progress[2];
  // Largest squared speed since the list was built [m2/s2]. A step reports it to the side that it leaves to
  // the next step; StepProgress::max_speed2 combines the two.
  float max_speed2[2]{};
  float max_overlap_ratio = 0;  // since the start; while a window runs, in this window [-]
  std::uint32_t steps = 0;      // micro steps in this window
  std::uint32_t error = 0;      // StepError bits
  // Errors of steps, reported to the side that a step leaves to the next: a GPU completes a step or does not
  // begin it.
  std::uint32_t step_error[2]{};
  std::uint32_t culprit = ~0u;     // see culprit(); the lowest of all
  std::uint32_t indices = 0;       // of spheres that passes run over
  std::uint32_t used = 0;          // indices from here on held no sphere when the lists were last built
  std::uint32_t near = 0;          // number of entries of ContactLists::near
  std::uint32_t listed = 0;        // pair entries in use
  std::uint32_t near_entries = 0;  // of the lists that were last built, which may not have fitted
  std::uint32_t unused = 0;        // so that equal records have equal bytes in files
  double dt = 0;                   // micro step [s]
  double skin = 0;                 // of the present list [m]
  SkinRange skins;                 // admissible skins
  double body_speed = 0;           // bound of the speed of any wall point in this window [m/s]
  Vec3d domain_shift;              // displacement of the domain since the start, where it follows a body [m]
  std::uint64_t rebuilds = 0;
  std::uint64_t lost = 0;
  // Of the lists that were last built: their entries, and the contacts carried over from the lists before.
  std::uint64_t list_entries = 0, wall_entries = 0, carried_entries = 0;
};

// Bound of the approach of two spheres, or of a sphere and a wall, in one micro step at the largest speed
// since the list was built [m].
TANDEM_HD inline double approach_now(const StepProgress& p, double dt, double body_speed) {
  const double speed = static_cast<double>(std::sqrt(p.max_speed2));
  return (speed + (body_speed > speed ? body_speed : speed)) * dt;
}
// Bound of their approach since the list was built, at that speed in every step, or with the jumps of walls
// [m].
TANDEM_HD inline double approached(const StepProgress& p, double dt, double body_speed) {
  const double so_far = p.wall_travel > p.travel ? p.wall_travel : p.travel,
               as_now = p.age * approach_now(p, dt, body_speed);
  return as_now > so_far ? as_now : so_far;
}

inline constexpr std::uint32_t steps_between_reviews = 64;  // of the age of a list

// Ends the micro step that is open. The list stays valid while no two spheres can have closed the skin
// between them. max_speed2, the largest squared speed since the list was built, bounds the speeds of this
// step; such a running maximum costs a GPU no atomic operation while it does not grow.
TANDEM_HD inline void close_step(float max_speed2, double dt, double skin, const SkinRange& skins,
                                 double body_speed, StepProgress& p) {
  if (p.open == 0) return;
  p.open = 0;
  if (max_speed2 > p.max_speed2) p.max_speed2 = max_speed2;
  if (p.max_speed2 > p.top_speed2) p.top_speed2 = p.max_speed2;
  const double moved = static_cast<double>(std::sqrt(p.max_speed2)) * dt;
  p.travel += 2 * moved;
  p.wall_travel += moved + body_speed * dt;
  p.rebuild_due = p.travel > skin || p.wall_travel > skin;
  if (++p.age % steps_between_reviews == 0)
    p.rebuild_due |= skins.outlived(skin, approached(p, dt, body_speed), p.age);
  p.state_side ^= 1;
  ++p.stamp;
  ++p.step;
}
TANDEM_HD inline void close_step(const WindowProgress& c, unsigned side, StepProgress& p) {
  close_step(c.max_speed2[side], c.dt, c.skin, c.skins, c.body_speed, p);
}

// Progress of the step after the one on `side`: closes that step and opens the next, unless a rebuild or an
// error comes first.
TANDEM_HD inline StepProgress next_step(const WindowProgress& c, unsigned side) {
  StepProgress p = c.progress[side];
  close_step(c, side, p);
  p.failed |= c.step_error[side];
  p.open = p.step < c.steps && p.rebuild_due == 0 && p.failed == 0 && (c.error & of_rebuilds) == 0;
  return p;
}

// The micro step in progress, for the functors of the step.
struct CurrentStep {
  std::uint32_t step, stamp, state_side;
  double dt;           // [s]
  double wall_travel;  // see StepProgress [m]

  TANDEM_HD CurrentStep(const WindowProgress& c, const StepProgress& p) : CurrentStep(c.dt, p) {}
  TANDEM_HD CurrentStep(double micro_step, const StepProgress& p)
      : step(p.step), stamp(p.stamp), state_side(p.state_side), dt(micro_step), wall_travel(p.wall_travel) {}
};

}  // namespace tandem::particles
