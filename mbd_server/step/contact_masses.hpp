// The inertia that a point of contact feels, and that of the bodies which press each other there. Uses the
// linear solver; changes the pressing masses of the points only.
#pragma once

#include <vector>

#include "mbd_server/solve/machine_system.hpp"
#include "mbd_server/step/contact_candidates.hpp"

namespace tandem::mbd {

// A candidate that comes into contact [m/s], [kg].
struct ContactEntry {
  std::size_t candidate;
  double rate, mass = 0, mass_a = 0, mass_b = 0;
  bool faint = false;
};

class ContactMasses {
 public:
  ContactMasses(const Model& model, MachineSystem& system);

  // The inertia that each entry feels, closures included: a unit force gives the gap the rate 1/m. At the
  // last residual of the system.
  void find(const ContactCandidates& candidates, std::vector<ContactEntry>& entries);
  // Machines that touch each other, other than through what is held, press each other. The largest mass that
  // a point of one of them feels counts, not their sum, which would damp each contact of a heap by its whole
  // mass.
  void press(std::vector<ContactPoint>& points);

 private:
  // Links that move with each other through joints or closures are one machine.
  int machine_of(int shape) const;

  const Model& model_;
  MachineSystem& system_;
  std::vector<int> machine_of_link_;           // none: ground (links)
  std::vector<bool> busy_;                     // (links)
  std::vector<int> pressed_with_;              // a machine, or itself (links)
  std::vector<double> pressing_;               // [kg] (links)
  std::vector<std::size_t> now_;               // entries that share a solution
  VectorXd unit_, response_, dlambda_, zero_;  // wrenches of unit forces at points, and their effect
};

}  // namespace tandem::mbd
