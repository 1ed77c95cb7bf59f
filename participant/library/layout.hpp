// The structs of the C interface have the layout of the protocol's, so that sets are handed over without a
// copy.
#pragma once

#include "participant/include/tandem/participant.h"
#include "protocol/messages.hpp"

namespace tandem::participant {

#define SAME(c, cpp) \
  static_assert(sizeof(c) == sizeof(cpp) && alignof(c) == alignof(cpp), #c " has not the layout of " #cpp)
#define SAME_FIELD(c, c_field, cpp, cpp_field) \
  static_assert(offsetof(c, c_field) == offsetof(cpp, cpp_field), #c "::" #c_field " has moved")

SAME(tandem_pose, Pose);
SAME(tandem_twist, Twist);
SAME(tandem_wrench, Wrench);
SAME(tandem_window, Window);
SAME(tandem_body_motion, protocol::BodyMotion);
SAME_FIELD(tandem_body_motion, begin_twist, protocol::BodyMotion, begin_twist);
SAME_FIELD(tandem_body_motion, begin_acceleration, protocol::BodyMotion, begin_a);
SAME_FIELD(tandem_body_motion, begin_angular_acceleration, protocol::BodyMotion, begin_alpha);
SAME_FIELD(tandem_body_motion, applied_impulse, protocol::BodyMotion, applied_impulse);
SAME(tandem_body_load, protocol::BodyLoad);
SAME_FIELD(tandem_body_load, first_moment, protocol::BodyLoad, first_moment);
SAME_FIELD(tandem_body_load, work, protocol::BodyLoad, work);
SAME(tandem_body_tangent, protocol::BodyTangent);
SAME_FIELD(tandem_body_tangent, damping, protocol::BodyTangent, damping);
SAME(tandem_body_response, protocol::BodyResponse);
SAME_FIELD(tandem_body_response, impulse, protocol::BodyResponse, impulse);
SAME(tandem_particle_account, protocol::ParticleAccount);
SAME_FIELD(tandem_particle_account, lost_momentum, protocol::ParticleAccount, lost_momentum);
SAME_FIELD(tandem_particle_account, lost_particles, protocol::ParticleAccount, lost_particles);
SAME(tandem_body_state, protocol::BodyState);
SAME(tandem_joint_state, protocol::JointState);
SAME_FIELD(tandem_joint_state, reaction, protocol::JointState, reaction);
#undef SAME
#undef SAME_FIELD

// The numbers of the two interfaces are the same.
static_assert(TANDEM_CAN_PREDICT == protocol::can_predict && TANDEM_CAN_ROLLBACK == protocol::can_rollback &&
              TANDEM_CAN_INTERPOLATE == protocol::can_interpolate &&
              TANDEM_CAN_WINDOW_MEAN == protocol::can_window_mean &&
              TANDEM_CAN_LINEARISE == protocol::can_linearise &&
              TANDEM_CAN_EXTRAPOLATE == protocol::can_extrapolate &&
              TANDEM_CAN_CONTROL == protocol::can_control &&
              TANDEM_CAN_CHECKPOINT == protocol::can_checkpoint &&
              TANDEM_CAN_OBSERVE_ELEMENTS == protocol::can_observe_elements &&
              TANDEM_CAN_OBSERVE_LIQUID == protocol::can_observe_liquid &&
              TANDEM_CAN_RESPOND == protocol::can_respond);

inline tandem_window view(const Window& window) {
  return {window.index, window.begin.count, window.end.count};
}

}  // namespace tandem::participant
