// Advances both solvers window by window: length of the window, scheme, rejection, balance, stability.
#pragma once

#include <string>
#include <vector>

#include "coordinator/accounts/accounts.hpp"
#include "coordinator/accounts/body_momentum.hpp"
#include "coordinator/schemes/path_space.hpp"
#include "coordinator/start/start.hpp"
#include "coordinator/watch/energy_watch.hpp"
#include "coordinator/watch/joint_watch.hpp"
#include "coordinator/watch/liquid_watch.hpp"
#include "coordinator/watch/motion_watch.hpp"
#include "coordinator/watch/path_watch.hpp"
#include "coordinator/watch/stability_watch.hpp"
#include "coordinator/window/window_control.hpp"

namespace tandem::launch {

struct CouplerCounters {
  std::uint64_t rejected = 0;    // windows that were repeated
  std::uint64_t iterations = 0;  // total number of passes of the particles through windows
  int most_iterations = 0;       // in one window
};

class Coupler {
 public:
  // Both references must outlive this object.
  Coupler(const scene::Scene& scene, const Solvers& solvers);

  // Bodies and sensors before the first window, as the participants have configured them.
  void begin_with(const StartOfSolvers& start) {
    motion_watch_.begin_with(start.boundary);
    exchange_.load.sensors = start.sensors;
  }
  // The bodies of a frame at the end of the last window.
  void observe(const protocol::BodiesFrame& frame);

  // The next window, no longer than until `limit`.
  Window next(Nanoseconds limit) const;
  // Advances both sides by one window, no further than `limit`.
  const Exchange& advance(Nanoseconds limit);

  // Saves or restores all state between two windows. The solvers save their own states.
  void save_or_restore(Archive& archive);

  Nanoseconds now() const { return now_; }  // end of the last window
  const Window& last_window() const { return window_; }
  const Exchange& exchange() const { return exchange_; }
  Exchange& exchange() { return exchange_; }
  const Accounts& accounts() const { return accounts_; }
  const BodyMomentum& body_momentum() const { return body_momentum_; }
  const MotionWatch& motion_watch() const { return motion_watch_; }
  const PathWatch& path_watch() const { return path_watch_; }
  const JointWatch& joint_watch() const { return joint_watch_; }
  const EnergyWatch& energy_watch() const { return energy_watch_; }
  const StabilityWatch& watch() const { return watch_; }
  const LiquidWatch& liquid_watch() const { return liquid_watch_; }
  const CouplerCounters& counters() const { return counters_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  std::uint64_t too_wrong() const { return control_.too_wrong(); }

 private:
  bool try_window(const Window& window);
  void look_at_contacts();
  void warn(const std::string& sentence);
  double distance() const;

  const scene::Scene& scene_;
  Solvers solvers_;
  std::unique_ptr<Scheme> scheme_;
  WindowControl control_;
  PathSpace space_;
  StabilityWatch watch_;
  LiquidWatch liquid_watch_;
  bool watching_;
  bool supported_;  // bodies have contacts with each other, and the multibody side reports them
  const protocol::TangentSet no_supports_;
  Exchange exchange_, before_;
  Accounts accounts_;
  BodyMomentum body_momentum_;
  MotionWatch motion_watch_;
  PathWatch path_watch_;
  JointWatch joint_watch_;
  EnergyWatch energy_watch_;
  CouplerCounters counters_;
  std::vector<std::string> warnings_;
  Nanoseconds now_;
  Window window_;  // the last one
  std::uint64_t windows_ = 0;
};

}  // namespace tandem::launch
