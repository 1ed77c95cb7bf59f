// Two solvers that run as servers in threads, and the coordinator's coupler, connected by real channels.
#pragma once

#include <memory>
#include <string>
#include <thread>

#include "coordinator/window/coupler.hpp"
#include "protocol/participant/solver.hpp"
#include "protocol/waiting.hpp"

namespace tandem::test {

enum class Channel { inproc, shm };

class CoupledRun {
 public:
  // The solvers must outlive this object. They receive `text`, the scene as JSON.
  CoupledRun(protocol::MotionSolver& mbd, protocol::LoadSolver& dem, const scene::Scene& scene,
             const std::string& text, Channel channel = Channel::inproc,
             protocol::WaitPolicy wait = protocol::WaitPolicy::adaptive);
  ~CoupledRun();
  CoupledRun(const CoupledRun&) = delete;
  CoupledRun& operator=(const CoupledRun&) = delete;

  // Advances by windows up to this time [s].
  void run(double end_time);
  // Advances by one window of this length [s], or of the scene's length where that is shorter.
  void advance(double length);

  // Gives the coupler the bodies at the end of the last window, as a run does after each.
  void observe();

  // Between two windows both servers wait, so that the solvers may be read and set.
  launch::Coupler& coupler() { return *coupler_; }
  const launch::Exchange& exchange() { return coupler_->exchange(); }
  const scene::Scene& scene() const { return scene_; }

 private:
  scene::Scene scene_;
  std::thread mbd_thread_, dem_thread_;
  std::unique_ptr<protocol::Remote> mbd_, dem_;
  std::unique_ptr<launch::Coupler> coupler_;
};

}  // namespace tandem::test
