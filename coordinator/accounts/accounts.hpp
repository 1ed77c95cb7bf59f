// The balance at the interface of the solvers: what one side gave against what the other side received, per
// window and over the run.
//
// Impulse:  the load of the particles on the bodies (mean load times H) against the load that moved the
// bodies. A load that a scheme holds is under way until the next window, and is counted as such. The part by
// which a scheme intentionally gives more or less than the recorded load of the same window is outstanding.
// Energy:   work of the particles along their prescribed path, including the displacement from its end to the
// actual end of the bodies, against the work that the bodies received along the path they took. The
// difference is the error of the coupling: positive when it created energy.
// Momentum: change of the particles' own momentum, also from the end of one window to the begin of the next
// one, against gravity, reactions of all bodies, and the momentum that left the domain. Limited by the
// precision of the stored particle state.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "coordinator/schemes/archive.hpp"
#include "coordinator/schemes/schemes.hpp"

namespace tandem::launch {

// What one body and the particles exchanged in one window.
struct BodyBalance {
  std::uint32_t body = 0;
  // Impulse: of the particles' load, of the load that acted on the body [N s], [N m s].
  Wrench recorded, applied;
  Wrench outstanding;   // impulse: recorded, but not sent to the body in this window [N s], [N m s]
  bool loaded = false;  // the particles recorded a load on it
  double given = 0, received = 0;  // work: done by the particles, received by the body [J]
};
struct WindowBalance {
  std::vector<BodyBalance> bodies;
  double created() const;    // received minus given [J]
  double exchanged() const;  // sum of the larger |work| of the two sides [J]
};

// The balance of momentum of the particles of one solver over the run.
class ParticleBalance {
 public:
  void record(const protocol::LoadSet& load);
  // `prefix`: of the names in a file.
  void save_or_restore(Archive& archive, const std::string& prefix);

  // Relative residual over the run so far [-], and with the errors of all windows added up by their sizes:
  // what one window gives for another does not cancel.
  double momentum() const;
  double momentum_windows() const;
  std::uint64_t micro_steps() const { return micro_steps_; }
  double largest_micro_step() const { return largest_micro_step_; }      // [s]
  const protocol::ParticleAccount& account() const { return account_; }  // of the last window

 private:
  Vec3d error_;           // sum over the windows [N s]
  double error_sum_ = 0;  // sum of the sizes of the errors of the windows [N s]
  double scale_[3] = {};  // sums of |change|, |gravity|, |loads| [N s]
  std::uint64_t micro_steps_ = 0;
  double largest_micro_step_ = 0;  // [s]
  protocol::ParticleAccount account_;
};

// Place of the liquid in Solvers::loads, where grains are first.
inline std::size_t place_of_liquid(const scene::Scene& scene) {
  return scene.dem ? 1 : 0;
}

class Accounts {
 public:
  static WindowBalance balance_of(const Exchange& exchange);
  void record(const Exchange& exchange);
  // `bodies`: number of bodies of the scene; `load_solvers`: number of solvers with particles.
  void save_or_restore(Archive& archive, std::size_t bodies, std::size_t load_solvers);

  const WindowBalance& last() const { return last_; }  // of the window recorded last
  const std::map<std::uint32_t, BodyBalance>& bodies() const { return bodies_; }  // over the run, by body

  // Relative residuals over the run so far [-]. Zero as long as nothing was exchanged.
  double impulse_closure() const;
  double impulse_outstanding() const;
  double energy_residual() const;

  // Of one load solver, by its place in Solvers::loads.
  const ParticleBalance& particles(std::size_t solver = 0) const;

  bool coupled() const { return !impulses_.empty(); }
  std::uint64_t windows() const { return windows_; }
  std::uint64_t micro_steps() const;  // of all particles
  double energy_exchanged() const {
    return energy_exchanged_;
  }                                                          // sum of the larger |work| of the two sides [J]
  double energy_created() const { return energy_created_; }  // received minus given [J]

 private:
  struct Impulse {
    Wrench under_way;              // of the last load, where it is held [N s], [N m s]
    double force = 0, torque = 0;  // sums of the recorded magnitudes [N s], [N m s]

    double relative(const Wrench& part) const;  // the larger of both shares [-]
  };

  WindowBalance last_;
  std::map<std::uint32_t, BodyBalance> bodies_;  // sums
  std::map<std::uint32_t, Impulse> impulses_;    // by body
  double energy_exchanged_ = 0, energy_created_ = 0;
  std::uint64_t windows_ = 0;
  std::vector<ParticleBalance> particles_;  // by solver, from the first window on
};

}  // namespace tandem::launch
