// The energy balance of the multibody part: energy that enters by work or leaves by dissipation, step by
// step.
//
//   residual = energy now - energy at the start - work of all loads, actuators and motions + dissipated
//
// is zero for the exact motion. Stored energy is known at any instant (observation.hpp); work and dissipation
// are integrals of effort times rate, over each step by Simpson's rule. The rate in the middle of a step is
// that of the cubic with the positions and rates at both ends, 3 ds / 2h - (v0 + v1) / 4, so that a constant
// force does exactly force times displacement, and a damper never returns energy. Forces over time are
// evaluated at begin, middle and end of the step. The effort of a driven joint is known at the ends only and
// taken as linear between them: the residual falls at least with h^2.
//
// In a step between close breaks of functions of time a force may rise from nothing: the rates are then
// exact, and the displacement is off by as much as a half. Where an acceleration keeps its direction over
// such a step, the rate in its middle is (v0 + v1) / 2 + h/8 (a0 - a1), which lies between v0 and v1.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "mbd_server/io/run_totals.hpp"
#include "mbd_server/solve/machine_system.hpp"

namespace tandem::mbd {

// Force or torque by which a prescribed motion moves the coordinate of its link, in the state of the last
// residual() [N m or N].
double effort_of_motion(const Model& model, LinkIndex link, const State& state, const MachineSystem& system);

// Keeps the state at the end of the last step. Does not allocate after the constructor; costs nothing for a
// machine without loads, drives, motions and dampers.
class EnergyBalance {
 public:
  explicit EnergyBalance(const Model& model);  // the model must outlive this object

  // Call where steps begin: after the state was set anew, or after loads or inputs have jumped. Both
  // functions assume the state of the last residual().
  void begin(const State& state, const MachineSystem& system);
  // Call at the end of a step of length h since the last begin() or add_step(); `sudden`: it is between close
  // breaks.
  void add_step(const State& state, const MachineSystem& system, double h, bool sudden, EnergySums& sums);

 private:
  // Position and rates of an elementary joint.
  struct Coordinates {
    std::array<double, 4> q;
    std::array<double, 3> u, udot;
  };
  struct JointPort {
    const JointForce* force;
    bool dissipates;
    Coordinates at{};
    std::array<double, 3> lost{};  // power lost in damper, friction, stops of each freedom [W]
    double drive = 0;              // of the actuator [N m or N]
    CoordinateMotion over{};       // of a size over a joint coordinate
  };
  struct MotionPort {
    LinkIndex link;
    Coordinates at{};
    double effort = 0;  // of the motion that drives the joint [N m or N]
  };
  JointPort at(const JointPort& port, const State& state, const MachineSystem& system) const;
  MotionPort at(const MotionPort& port, const State& state, const MachineSystem& system) const;

  Coordinates coordinates(LinkIndex link, const State& state, const MachineSystem& system) const;
  std::array<double, 3> displacement(LinkIndex link, const Coordinates& from, const Coordinates& to,
                                     double h) const;

  void add(const JointPort& from, const JointPort& to, double h, EnergySums& sums) const;
  void add(const MotionPort& from, const MotionPort& to, double h, EnergySums& sums) const;

  const Model& model_;
  double time_ = 0;           // of the last begin() or add_step() [s]
  bool sudden_ = false;       // the step that is being added
  StopContactRows contacts_;  // of the stops, during the step
  std::vector<std::unique_ptr<EnergyPort>> forces_;
  std::vector<JointPort> joints_;
  std::vector<MotionPort> motions_;
  State between_;  // time and inputs in the middle of a step
};

}  // namespace tandem::mbd
