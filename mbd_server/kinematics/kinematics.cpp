#include "mbd_server/kinematics/kinematics.hpp"

namespace tandem::mbd {

void compute_kinematics(const Model& model, const State& state, std::vector<LinkMotion>& links,
                        const VectorXd* driven) {
  links.resize(model.links.size());
  links[0].A = spatial(Vector3d::Zero(), -model.gravity);

  for (std::size_t i = 1; i < links.size(); ++i) {
    const Link& link = model.links[i];
    const LinkMotion& parent = links[link.parent];
    LinkMotion& m = links[i];

    if (link.motion != none) {
      m.coordinate = model.motions[link.motion].at(state.time, state.side);
      if (driven) m.coordinate.acceleration += (*driven)[link.motion];
    } else if (freedoms(link.kind) == 1)
      m.coordinate = {state.q[link.q], state.u[link.u], state.udot[link.u]};

    const double* q = link.motion != none ? &m.coordinate.value : &state.q[link.q];
    const JointPose joint = joint_pose(link.kind, link.axis, link.pitch, q);
    m.q_WL = parent.q_WL * joint.rotation;
    m.R_WL = m.q_WL.toRotationMatrix();
    m.p_WL = parent.p_WL + parent.R_WL * (link.offset + joint.displacement);

    m.columns = motion_subspace(link.kind, link.axis, link.pitch, m.R_WL, m.p_WL, m.S);
    Vector6d joint_velocity, joint_acceleration;
    if (m.columns == 1) {
      joint_velocity = m.S.col(0) * m.coordinate.rate;
      joint_acceleration = m.S.col(0) * m.coordinate.acceleration;
    } else {
      joint_velocity = m.S * state.u.segment<3>(link.u);
      joint_acceleration = m.S * state.udot.segment<3>(link.u);
    }
    m.V = parent.V + joint_velocity;
    m.A = parent.A + joint_acceleration + cross_motion(m.V, joint_velocity);
  }
}

}  // namespace tandem::mbd
