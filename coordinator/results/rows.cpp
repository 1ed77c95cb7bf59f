#include "coordinator/results/rows.hpp"

namespace tandem::launch {
namespace {

void add_vector(std::vector<double>& row, Vec3d v) {
  row.insert(row.end(), {v.x, v.y, v.z});
}

}  // namespace

void add_body_values(const scene::Scene& scene, const protocol::BodiesFrame* bodies,
                     const protocol::LoadSet* loads, std::vector<double>& row) {
  const std::size_t count = scene.mbd ? scene.mbd->bodies.size() : 0;
  // Bodies without walls have no contact load and are not in the load set.
  std::vector<Wrench> load(count + 1);
  if (loads != nullptr) {
    for (const protocol::BodyLoad& body : loads->bodies) {
      load.at(BodyId{body.body} == ground ? count : body.body) = body.mean;
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const protocol::BodyState& body = bodies->bodies[i];
    const Quat& q = body.pose.q_WB;
    add_vector(row, body.pose.p_WB);
    row.insert(row.end(), {q.w, q.x, q.y, q.z});
    add_vector(row, body.twist.v_WB);
    add_vector(row, body.twist.w_WB);
    if (!scene.has_particles()) continue;
    add_vector(row, load[i].force);
    add_vector(row, load[i].torque);
  }
  if (scene.has_particles()) {
    add_vector(row, load[count].force);
    add_vector(row, load[count].torque);
  }
}

void add_joint_values(const protocol::BodiesFrame& bodies, std::vector<double>& row) {
  for (const protocol::JointState& joint : bodies.joints) {
    row.push_back(joint.q);
    row.push_back(joint.rate);
    add_vector(row, joint.reaction.force);
    add_vector(row, joint.reaction.torque);
    row.push_back(joint.undetermined);
  }
}

}  // namespace tandem::launch
