// Energy that enters the machine by work or leaves it by dissipation.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace tandem::mbd {

// See energy_balance.hpp [J].
struct EnergySums {
  double particle_work = 0;    // of the particle loads
  double load_work = 0;        // of forces and torques of the scene
  double actuator_work = 0;    // of actuators over time and of those with a control input
  double motion_work = 0;      // of the prescribed motions of joints
  double dissipated = 0;       // in dampers, friction, stops and bushings
  double turnover = 0;         // sum of the sizes of all of these, step by step
  double kinetic = 0;          // at the end of the last step
  double largest_kinetic = 0;  // at the end of a step
  // Shares of the elements of the scene in work and dissipation (Model::accounts).
  std::vector<double> work_of, lost_of;

  double work() const { return particle_work + load_work + actuator_work + motion_work; }
  // Adds an energy to one of the sums and its size to the turnover.
  void add(double EnergySums::*sum, double energy) {
    this->*sum += energy;
    turnover += std::abs(energy);
  }
  // The same for an energy of one element.
  void add(double EnergySums::*sum, double energy, int account) {
    add(sum, energy);
    if (account >= 0)
      (sum == &EnergySums::dissipated ? lost_of : work_of)[static_cast<std::size_t>(account)] += energy;
  }
};

}  // namespace tandem::mbd
