// The books of the border: what one side gave against what the other side received, per window and over the
// run.
//
// Impulse:  what the particles booked on the bodies (mean load times H) against what the bodies were moved
// by.
//           A load that a scheme holds is under way until the next window; it is counted as such. What a
//           scheme knowingly gives beyond or below the booked load of the same window is outstanding.
// Energy:   work that the particles did along the path they were given, with the step from its end to where
// the bodies
//           really came, against the work that the bodies received along the path they took. The difference
//           is the error of the coupling: positive when it created energy.
// Momentum: change of the particles' own momentum against gravity, reactions of all bodies, and what left the
// domain.
//           Limited by the precision of the stored particle state.
#pragma once

#include <map>

#include "launch/coordinator/archive.hpp"
#include "launch/coordinator/schemes.hpp"

namespace tandem::launch {

// What one body and the particles booked on each other in one window.
struct BodyBooks {
  std::uint32_t body = 0;
  Wrench booked, applied;  // impulse: of the particles' load, of the load that the body got [N s], [N m s]
  Wrench outstanding;      // impulse: booked, but not sent to the body in this window [N s], [N m s]
  bool loaded = false;     // the particles booked a load on it
  double given = 0, received = 0;  // work: done by the particles, received by the body [J]
};
struct WindowBooks {
  std::vector<BodyBooks> bodies;
  double created() const;    // received minus given [J]
  double exchanged() const;  // sum of the larger |work| of the two sides [J]
};

class Accounts {
 public:
  static WindowBooks books_of(const Exchange& exchange);
  void book(const Exchange& exchange);
  // `bodies`: of the scene.
  void keep(Archive& archive, std::size_t bodies);

  const WindowBooks& last() const { return last_; }                             // of the window booked last
  const std::map<std::uint32_t, BodyBooks>& bodies() const { return bodies_; }  // over the run, by body

  // Of the run so far, relative [-]. Zero where nothing was exchanged yet.
  double impulse_closure() const;
  double impulse_outstanding() const;
  double energy_residual() const;
  double momentum_balance() const;

  bool coupled() const { return !impulses_.empty(); }
  std::uint64_t windows() const { return windows_; }
  std::uint64_t micro_steps() const { return micro_steps_; }
  double energy_exchanged() const {
    return energy_exchanged_;
  }                                                          // sum of the larger |work| of the two sides [J]
  double energy_created() const { return energy_created_; }  // received minus given [J]
  const protocol::ParticleAccount& particles() const { return particles_; }  // of the last window

 private:
  struct Impulse {
    Wrench under_way;              // of the last load, where it is held [N s], [N m s]
    double force = 0, torque = 0;  // sums of the booked magnitudes [N s], [N m s]

    double relative(const Wrench& part) const;  // the larger of both shares [-]
  };

  WindowBooks last_;
  std::map<std::uint32_t, BodyBooks> bodies_;  // sums
  std::map<std::uint32_t, Impulse> impulses_;  // by body
  double energy_exchanged_ = 0, energy_created_ = 0;
  Vec3d momentum_error_;           // sum over the windows [N s]
  double momentum_scale_[3] = {};  // sums of |change|, |gravity|, |loads| [N s]
  std::uint64_t windows_ = 0, micro_steps_ = 0;
  protocol::ParticleAccount particles_;
};

}  // namespace tandem::launch
