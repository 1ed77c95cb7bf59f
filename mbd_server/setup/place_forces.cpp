#include <algorithm>

#include "common/error.hpp"
#include "common/scene/columns.hpp"
#include "mbd_server/forces/body_load.hpp"
#include "mbd_server/forces/bushing.hpp"
#include "mbd_server/forces/gas_spring.hpp"
#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/forces/rope.hpp"
#include "mbd_server/forces/spring_damper.hpp"
#include "mbd_server/forces/tyre.hpp"
#include "mbd_server/setup/placement.hpp"

namespace tandem::mbd {
namespace {

Matrix6d matrix(const std::array<double, 36>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(rows.data());
}

// Adds one force of the scene to the model.
struct Placer {
  const Placement& at;
  Model& model;
  std::string where;
  int account;
  const std::vector<std::string>& inputs;

  template <class Data>
  void add(Data data) const {
    model.forces.push_back(make_force(std::move(data)));
  }
  int add_force_over_time(const scene::Motion& size) const {
    model.drives.emplace_back(size, scene::FunctionOf::force);
    model.drive_is_force.push_back(true);
    return static_cast<int>(model.drives.size()) - 1;
  }

  SizeOverJoint over_joint(const scene::JointFunction& f) const {
    return {model.joints.at(f.joint.value).coordinate_link, f.of_rate,
            PeriodicCurve(f.table.arguments, f.table.values, f.period, PeriodicCurve::Smoothness::slope)};
  }

  void operator()(const scene::SpringDamper& f) const {
    add(Spring{f.name, at.point(model, f.body_a, f.point_a), at.point(model, f.body_b, f.point_b),
               ForceLaw(f.stiffness, f.table), ForceLaw(f.damping, f.damping_table), f.length, account});
  }
  void operator()(const scene::RotationalSpringDamper& f) const {
    const SceneJoint& joint = model.joints.at(f.joint.value);
    if (joint.type != scene::JointType::revolute)
      throw Error(ErrorCode::scene,
                  "rotational spring \"" + f.name + "\" acts on joint \"" +
                      at.scene.mbd->joints[f.joint.value].name + "\", which is not revolute",
                  where, "name a revolute joint");
    JointForce& force = model.joint_forces.emplace_back();
    force.account = account;
    force.link = joint.coordinate_link;
    force.rest = f.angle;
    force.elastic = ForceLaw(f.stiffness, f.table);
    force.viscous = ForceLaw(f.damping, f.damping_table);
  }
  void operator()(const scene::Bushing& f) const {
    add(BushingOnLinks{f.name, at.point(model, f.body_a, f.position), at.point(model, f.body_b, f.position),
                       matrix(f.stiffness), matrix(f.damping), account});
  }
  void operator()(const scene::Rope& f) const {
    RopeOnLinks rope;
    rope.name = f.name;
    rope.account = account;
    for (const scene::RopePoint& p : f.points) rope.points.push_back(at.point(model, p.body, p.point));
    rope.length = f.length;
    rope.stiffness = f.axial_stiffness / f.length;
    rope.damping = f.damping;
    if (!f.drum) return add(std::move(rope));
    rope.drum = model.joints.at(f.drum->value).coordinate_link;
    rope.per_angle = scene::drum_lead(f, at.scene.mbd->joints).per_angle;
    rope.drum_body = model.joints.at(f.drum->value).child;
    for (const PointOnBody& p : rope.points)
      if (p.link == rope.drum)
        throw Error(ErrorCode::scene, "rope \"" + f.name + "\" has a point that turns with its drum", where,
                    "give points of bodies that are not fixed to the drum");
    add(std::move(rope));
  }
  void operator()(const scene::BodyLoad& f) const {
    const bool torque = f.kind == scene::BodyLoad::Kind::torque;
    const Vec3d point = torque ? at.scene.mbd->bodies[f.body.value].pose.p_WB : f.point;
    LoadOnLink load{.at = at.point(model, f.body, point),
                    .direction = to_eigen(f.direction).normalized(),
                    .torque = torque,
                    .follows = f.follows,
                    .account = account};
    if (f.over)
      load.over = over_joint(*f.over);
    else
      load.drive = add_force_over_time(f.size);
    add(std::move(load));
  }
  void operator()(const scene::Actuator& f) const {
    JointForce& force = model.joint_forces.emplace_back();
    force.account = account;
    force.link = model.joints.at(f.joint.value).coordinate_link;
    if (f.over) {
      force.over = over_joint(*f.over);
      return;
    }
    if (!f.input.empty()) {
      const auto found = std::find(inputs.begin(), inputs.end(), f.input);
      force.input = static_cast<int>(found - inputs.begin());
      return;
    }
    force.drive = add_force_over_time(f.size);
  }
  void operator()(const scene::Tyre& f) const {
    const scene::Joint& joint = at.scene.mbd->joints[f.joint.value];
    TyreOnLink tyre;
    tyre.name = f.name;
    tyre.account = account;
    tyre.centre = at.point(model, joint.child, joint.child_position.value_or(joint.position));
    // Link frames are parallel to the world in the pose of the file.
    tyre.axle = to_eigen(joint.axis).normalized();
    tyre.normal = to_eigen(f.road_normal).normalized();
    tyre.height = tyre.normal.dot(to_eigen(f.road_point) - model.origin);
    tyre.radius = f.radius, tyre.stiffness = f.stiffness, tyre.damping = f.damping;
    tyre.friction = f.friction;
    tyre.slip_stiffness = f.slip_stiffness, tyre.cornering_stiffness = f.cornering_stiffness;
    tyre.relaxation_x = f.relaxation_length;
    tyre.relaxation_y = f.lateral_relaxation_length.value_or(f.relaxation_length);
    tyre.rolling_resistance = f.rolling_resistance;
    tyre.patch = f.patch_length;
    const std::string tread = " of the tread of tyre \"" + f.name + "\"";
    tyre.state = add_first_order_state(model, 0, tyre.relaxation_x, "deflection along" + tread);
    add_first_order_state(model, 0, tyre.relaxation_y, "deflection across" + tread);
    place_road(at.scene, f, where, model, tyre);
    add(std::move(tyre));
  }
  void operator()(const scene::GasSpring& f) const {
    GasSpring gas;
    gas.area = f.piston_area, gas.volume = f.volume, gas.exponent = f.exponent;
    gas.pressure = f.pressure, gas.ambient = f.ambient_pressure, gas.leakage = f.leakage;
    Element element;
    element.name = "gas spring \"" + f.name + "\"";
    element.account = account;
    element.a = at.point(model, f.body_a, f.point_a), element.b = at.point(model, f.body_b, f.point_b);
    element.length = norm(f.point_b - f.point_a);
    element.damping = f.damping, element.ends = f.limits;
    if (f.leakage > 0) {
      element.state = add_first_order_state(model, 1, 1, "share of gas in " + element.name);
      element.states = 1;
    }
    element.law = std::make_shared<GasSpring>(gas);
    add(std::move(element));
  }
  void operator()(const scene::Motor& f) const { place_element(f, account, inputs, model); }
  void operator()(const scene::Cylinder& f) const { place_element(at, f, account, inputs, model); }
};

}  // namespace

// Makes the friction of the last joint force stiction where it has a breakaway.
void add_stiction(Model& model) {
  JointForce& force = model.joint_forces.back();
  if (!force.friction || !force.friction->breakaway || model.links[force.link].motion != none) return;
  force.stiction = static_cast<int>(model.stictions.size());
  model.stictions.push_back(static_cast<int>(model.joint_forces.size()) - 1);
}

namespace {

// Damping acts on all links of the joint's chain.
void place_joint_forces(const Placement& placement, Model& model) {
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const scene::Joint& joint = placement.scene.mbd->joints[j];
    const SceneJoint& in_model = model.joints[j];
    if (in_model.closure != none || (joint.damping == 0 && !joint.limits && !joint.friction)) continue;
    const bool reversed = in_model.reversed;
    const int outer = reversed ? in_model.parent : in_model.child,
              inner = reversed ? in_model.child : in_model.parent;
    const LinkIndex last = model.bodies[outer].link, first = inner == none ? 0 : model.bodies[inner].link;
    for (LinkIndex l = last; l != first; l = model.links[l].parent) {
      JointForce& force = model.joint_forces.emplace_back();
      force.link = l;
      force.account = placement.of_joint[j];
      force.viscous = ForceLaw(joint.damping);
      force.limits = joint.limits;
      if (joint.limits && joint.limits->restitution)
        force.damping_number = damping_number(*joint.limits->restitution);
      if (joint.limits && model.links[l].motion == none) {
        force.stop = static_cast<int>(model.stops.size());
        model.stops.push_back(static_cast<int>(model.joint_forces.size()) - 1);
      }
      force.friction = joint.friction;
      add_stiction(model);
    }
  }
}

}  // namespace

void Placement::number_accounts(Model& model) {
  const scene::Mbd& mbd = *scene.mbd;
  of_joint.assign(mbd.joints.size(), none);
  of_coupler.assign(mbd.couplers.size(), none);
  of_force.assign(mbd.forces.size(), none);
  of_contact.assign(scene.contact ? scene.contact->outputs.size() : 0, none);
  for (const scene::ElementOfScene& element : scene::elements_of(scene)) {
    using Source = scene::ElementOfScene::Source;
    std::vector<int>& accounts = element.source == Source::joint     ? of_joint
                                 : element.source == Source::coupler ? of_coupler
                                 : element.source == Source::contact ? of_contact
                                                                     : of_force;
    accounts[element.index] = model.accounts++;
  }
}

void place_forces(const Placement& placement, Model& model) {
  place_joint_forces(placement, model);
  const auto& forces = placement.scene.mbd->forces;
  const std::vector<std::string> inputs = scene::control_inputs(*placement.scene.mbd);
  model.inputs = static_cast<int>(inputs.size());
  for (std::size_t f = 0; f < forces.size(); ++f)
    std::visit(
        Placer{placement, model, "mbd.forces[" + std::to_string(f) + "]", placement.of_force[f], inputs},
        forces[f]);
  std::ranges::stable_sort(model.forces, {}, [](const auto& force) { return force->order().forces; });
}

}  // namespace tandem::mbd
