// Checks of a payload's values. Each check throws ProtocolError with record, body, field and value; nothing
// is repaired. Both ends check the messages that they send and receive.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/messages.hpp"

namespace tandem::protocol {

// The bodies with walls; known from the multibody side's first answer, or from the first path sent.
class BoundaryBodies {
 public:
  bool known() const { return known_; }
  void assign(const std::vector<BodyMotion>& boundary);  // throws on a repeated body and on the ground
  // Throws unless the list has each boundary body once, and no other body.
  void expect_all(const std::vector<BodyMotion>& bodies);
  // Throws unless each element is a boundary body or the ground, at most once.
  void expect_some(const std::vector<BodyLoad>& bodies);
  // Throws unless each element is a boundary body, at most once.
  void expect_some(const std::vector<BodyTangent>& bodies);
  void expect_some(const std::vector<BodyResponse>& bodies);

 private:
  void mark(std::uint32_t body, bool may_be_ground);
  std::vector<std::uint32_t> ids_;  // ascending; the ground is the last
  std::vector<bool> seen_;
  bool known_ = false;
};

void check_values(const Configuration& value);
void check_values(const Configured& value);
void check_values(const MotionSet& value);
void check_values(const LoadSet& value);
void check_values(const TangentSet& value);
void check_values(const ControlSet& value);
void check_values(const Checkpoint& value);
// dt > 0, a whole number of micro steps fills the window, and neither energy nor overlap is negative; for
// loads that come from the particle side.
void check_account(const LoadSet& value);
void check_values(const BodiesFrame& value);
void check_values(const ParticlesFrame& value);

}  // namespace tandem::protocol
