// What a window's progress is steered by: one record that lives beside the particles, on the device if they
// are. The host writes it at a window's begin and reads it at the end; in between nobody else decides when
// the neighbour list is rebuilt, so that this costs no round trip.
#pragma once

#include <cmath>
#include <cstdint>

#include "common/math/vec3.hpp"
#include "dem_server/grid/skin.hpp"

namespace tandem::dem {

enum StepError : std::uint32_t {
  not_finite = 1u << 0,              // a sphere's velocity is no number, or beyond the speed limit
  list_overflow = 1u << 1,           // a list, or what a rebuild carries over, is longer than its memory
  wall_contacts_overflow = 1u << 2,  // one sphere touches more surfaces of one body than can be told apart
  force_range = 1u << 3,             // a wall force beyond the range of the exact sums
  region_overflow =
      1u << 4,  // a region of backend/cuda/resident/resident.cuh does not fit: go on without regions
  blocks_apart = 1u << 5,  // a barrier of backend/cuda/resident/resident.cuh waited in vain
};

inline constexpr std::uint32_t of_rebuilds = list_overflow | region_overflow;

// Which sphere raised what, as a number that is the lower the graver: of several errors in one step the
// gravest is told, and of the spheres that raised it the one with the lowest id.
inline constexpr std::uint32_t most_culprits = 1u << 30;  // ids that it tells apart
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
  std::uint32_t open = 0;         // a micro step is being done
  std::uint32_t failed = 0;       // one before this has reported an error
  float max_speed2 = 0;           // largest squared speed since the list was built [m2/s2]
  float top_speed2 = 0;           // largest max_speed2 in this window [m2/s2]
  std::uint32_t age = 0;          // micro steps since the list was built
  double travel = 0;              // bound of the approach of two spheres since the list was built [m]
  double wall_travel = 0;         // bound of the approach of a sphere and a wall since then [m]
};

// Progress is double buffered like the state. Each kernel of a step derives where it stands from the half
// that the step before has left, which nobody writes meanwhile, and the step writes the other half; so no
// kernel waits for another one's bookkeeping. The side of a step is its number in the round of steps; a round
// has an even number of them, and side 0 is current between rounds. The CPU has side 0 alone.
struct WindowProgress {
  StepProgress progress[2];
  // Largest squared speed since the list was built [m2/s2]. A step reports it to the side that it leaves to
  // the next; Progress::max_speed2 joins the two.
  float max_speed2[2]{};
  float max_overlap_ratio = 0;  // since the start; while a window runs, in this window [-]
  std::uint32_t steps = 0;      // micro steps in this window
  std::uint32_t error = 0;      // StepError bits
  // Those of steps, reported to the side that a step leaves to the next: a GPU does a step to its end, or not
  // at all.
  std::uint32_t step_error[2]{};
  std::uint32_t culprit = ~0u;     // see culprit(): of all, the lowest
  std::uint32_t indices = 0;       // for spheres, that are looked at
  std::uint32_t used = 0;          // indices from here on held no sphere when the lists were built last
  std::uint32_t near = 0;          // pairs of a sphere and a body near it
  std::uint32_t listed = 0;        // pair entries that are in use
  std::uint32_t near_entries = 0;  // of the lists that were built last, which may not have fitted
  double dt = 0;                   // micro step [s]
  double skin = 0;                 // of the list [m]
  SkinRange skins;                 // what it may be
  double body_speed = 0;           // bound of the speed of any wall point in this window [m/s]
  Vec3d domain_shift;              // of the domain since the start, where it follows a body [m]
  std::uint64_t rebuilds = 0;
  std::uint64_t lost = 0;
  // Of the lists that were built last: entries, and contacts that went over to them from those before.
  std::uint64_t list_entries = 0, wall_entries = 0, carried_entries = 0;
};

// By how much two spheres, or a sphere and a wall, come nearer in a micro step at the largest speed since the
// list was built [m].
TANDEM_HD inline double approach_now(const StepProgress& p, double dt, double body_speed) {
  const double speed = static_cast<double>(std::sqrt(p.max_speed2));
  return (speed + (body_speed > speed ? body_speed : speed)) * dt;
}
// By how much they came nearer since then, if it went on like that; or with the jumps of walls [m].
TANDEM_HD inline double approached(const StepProgress& p, double dt, double body_speed) {
  const double so_far = p.wall_travel > p.travel ? p.wall_travel : p.travel,
               as_now = p.age * approach_now(p, dt, body_speed);
  return as_now > so_far ? as_now : so_far;
}

inline constexpr std::uint32_t steps_between_reviews = 64;  // of a list's skin

// Ends the micro step that is open: the list stays valid while no two spheres can have closed the skin
// between them. max_speed2, the largest squared speed since the list was built, bounds that of this step; a
// running maximum costs a GPU no atomic where it does not grow.
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

// Where the step stands that follows the one on `side`: closes that one and opens the next, unless there is
// something else to do first.
TANDEM_HD inline StepProgress next_step(const WindowProgress& c, unsigned side) {
  StepProgress p = c.progress[side];
  close_step(c, side, p);
  p.failed |= c.step_error[side];
  p.open = p.step < c.steps && p.rebuild_due == 0 && p.failed == 0 && (c.error & of_rebuilds) == 0;
  return p;
}

// The micro step that is being done, for the functors that do it.
struct CurrentStep {
  std::uint32_t step, stamp, state_side;
  double dt;           // [s]
  double wall_travel;  // see Progress [m]

  TANDEM_HD CurrentStep(const WindowProgress& c, const StepProgress& p) : CurrentStep(c.dt, p) {}
  TANDEM_HD CurrentStep(double micro_step, const StepProgress& p)
      : step(p.step), stamp(p.stamp), state_side(p.state_side), dt(micro_step), wall_travel(p.wall_travel) {}
};

}  // namespace tandem::dem
