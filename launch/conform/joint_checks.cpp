// Checks of a multibody participant on joints and actuators.
#include "common/scene/element_columns.hpp"
#include "launch/conform/check.hpp"
#include "launch/conform/sample.hpp"

namespace tandem::conform {
namespace {

using protocol::BodyLoad;

constexpr std::uint32_t door = 0, drawer = 1, hinge = 0, slide = 1;

const protocol::JointState& joint_of(const protocol::BodiesFrame& frame, std::uint32_t joint) {
  for (const protocol::JointState& state : frame.joints)
    if (state.joint == joint) return state;
  throw Error(ErrorCode::protocol, "the frame has no joint " + std::to_string(joint), "mbd_server",
              "send each joint of the scene");
}

// Loads across the free direction of each joint: nothing moves, and the joint bears all.
void joint_reaction(Examination& e) {
  const auto session = e.open();
  std::vector<BodyLoad> loads(2);
  loads[0].body = door;
  loads[0].mean = {{3, 0, -5}, {0.7, -0.4, 0}};
  loads[1].body = drawer;
  loads[1].mean = {{0, 2, -6}, {0.3, 0.5, -0.2}};
  for (int i = 0; i < 3; ++i) session->advance(loads, H);
  const protocol::BodiesFrame frame = session->bodies();
  for (const std::uint32_t joint : {hinge, slide}) {
    const scene::Joint& of_scene = e.scene().mbd->joints[joint];
    const scene::Body& body = e.scene().mbd->bodies[of_scene.child.value];
    const Wrench& load = loads[joint].mean;
    const Vec3d force = -(load.force + body.mass * e.scene().gravity);
    const Vec3d torque = cross(body.pose.p_WB - of_scene.position, force) - load.torque;
    const Wrench& reaction = joint_of(frame, joint).reaction;
    e.compare("force of the " + of_scene.name + " on the " + body.name, reaction.force, force,
              1e-3 * norm(force), "N");
    e.compare("torque of the " + of_scene.name + " about its point", reaction.torque, torque,
              1e-3 * norm(torque), "N m");
    e.compare("coordinate of the " + of_scene.name, joint_of(frame, joint).q, 0, 1e-6, "");
  }
}

// Loads along the free direction of each joint.
void joint_motion(Examination& e) {
  const auto session = e.open();
  std::vector<BodyLoad> loads(2);
  loads[0].body = door;
  loads[0].mean.torque = {0, 0, 3};
  loads[1].body = drawer;
  loads[1].mean.force = {-8, 0, 0};
  for (int i = 0; i < 40; ++i) session->advance(loads, H);
  const double t = session->time();
  const protocol::BodiesFrame frame = session->bodies();
  const scene::Body& leaf = e.scene().mbd->bodies[door];
  const double arm = leaf.pose.p_WB.x - e.scene().mbd->joints[hinge].position.x;
  const double angular = 3 / (leaf.inertia[2] + leaf.mass * arm * arm);
  const double linear = -8 / e.scene().mbd->bodies[drawer].mass;
  e.compare("rate of the hinge", joint_of(frame, hinge).rate, angular * t, 1e-3 * angular * t, "rad/s");
  e.compare("angle of the hinge", joint_of(frame, hinge).q, 0.5 * angular * t * t, 5e-3 * angular * t * t,
            "rad");
  e.compare("rate of the slide", joint_of(frame, slide).rate, linear * t, 1e-3 * -linear * t, "m/s");
  e.compare("travel of the slide", joint_of(frame, slide).q, 0.5 * linear * t * t, 5e-3 * -linear * t * t,
            "m");
}

// The value holds until the next one, and is part of what save() keeps.
void control(Examination& e) {
  const auto session = e.open();
  const double mass = e.scene().mbd->bodies[0].mass;
  const auto give = [&](double force) { session->remote().control({session->now(), {force}}); };
  const auto rate_after = [&](int count) {
    for (int i = 0; i < count; ++i) session->advance(std::vector<BodyLoad>{}, H);
    return joint_of(session->bodies(), 0).rate;
  };
  give(6);
  const double first = rate_after(10), second = rate_after(10);
  e.compare("rate under a control input", first, 6 / mass * 10 * H, 1e-3 * 6 / mass * 10 * H, "m/s");
  e.compare("rate while it holds", second, 6 / mass * 20 * H, 1e-3 * 6 / mass * 20 * H, "m/s");
  if (!session->remote().can(protocol::can_rollback)) return;
  session->save();
  give(-20);
  rate_after(5);
  session->restore();
  e.compare("rate after a restore, by the input that was saved", rate_after(10), 6 / mass * 30 * H,
            1e-3 * 6 / mass * 30 * H, "m/s");
}

// An actuator pushes a body: force, rate, power and work in the columns of elements.csv.
void elements(Examination& e) {
  const auto session = e.open();
  const double force = 6, mass = e.scene().mbd->bodies[0].mass;
  session->remote().control({session->now(), {force}});
  for (int i = 0; i < 20; ++i) session->advance(std::vector<BodyLoad>{}, H);
  const double rate = force / mass * session->time(), work = 0.5 * mass * rate * rate;
  const std::vector<double> values = session->bodies().elements;
  const auto columns = static_cast<double>(scene::element_columns(e.scene()).size());
  e.compare("number of values of elements", static_cast<double>(values.size()), columns, 0, "");
  if (values.size() != 4) return;
  e.compare("force of the actuator", values[0], force, 1e-9 * force, "N");
  e.compare("rate at the actuator", values[1], rate, 1e-3 * rate, "m/s");
  e.compare("power of the actuator", values[2], force * rate, 1e-3 * force * rate, "W");
  e.compare("work of the actuator", values[3], work, 5e-3 * work, "J");
}

}  // namespace

void add_joint_checks(std::vector<Check>& table) {
  table.push_back({"joint_reaction",
                   "the reaction of a joint is that on the child, about the joint's point, in world axes", 0,
                   "joints", nullptr, false, joint_reaction});
  table.push_back(
      {"joint_motion",
       "coordinates of a hinge and a slide are zero in the scene's pose, and positive along the axis", 0,
       "joints", nullptr, false, joint_motion});
  table.push_back({"control",
                   "a control input acts until the next one, and restore goes back to the one that was saved",
                   protocol::can_control, "actuated", nullptr, false, control});
  table.push_back({"elements", "the frame for the results has force, rate, power and work of an actuator",
                   protocol::can_control | protocol::can_observe_elements, "actuated", nullptr, false,
                   elements});
}

}  // namespace tandem::conform
