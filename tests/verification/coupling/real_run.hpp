// Both real solvers, coupled over channels in one process.
#pragma once

#include "common/scene/parse.hpp"
#include "dem_server/coupling/load_solver.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"
#include "tests/doubles/coupled_run.hpp"

namespace tandem::test {

class RealRun {
 public:
  explicit RealRun(const std::string& text) : RealRun(text, scene::parse(text, "test").coupling) {}
  // The coordinator couples in another way than the solvers are told.
  RealRun(const std::string& text, const scene::Coupling& coupling)
      : run_(mbd, dem, coupled(scene::parse(text, "test"), coupling), text) {}

  mbd::MbdSolver mbd;
  dem::Solver dem;

  void run(double end_time) { run_.run(end_time); }
  launch::Coupler& coupler() { return run_.coupler(); }

  // Of the body with this index.
  protocol::BodyState body(std::size_t index) { return mbd.observe().bodies.at(index); }
  // Centre and velocity of a sphere along an axis [m] [m/s].
  double position(std::size_t sphere, int axis) {
    return dem.observe().position.at(3 * sphere + static_cast<std::size_t>(axis));
  }
  double velocity(std::size_t sphere, int axis) {
    return static_cast<double>(dem.observe().velocity.at(3 * sphere + static_cast<std::size_t>(axis)));
  }

 private:
  static scene::Scene coupled(scene::Scene scene, const scene::Coupling& coupling) {
    scene.coupling = coupling;
    return scene;
  }
  CoupledRun run_;
};

}  // namespace tandem::test
