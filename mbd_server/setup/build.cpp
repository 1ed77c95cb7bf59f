#include "mbd_server/setup/build.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/error.hpp"
#include "mbd_server/forces/force_element.hpp"
#include "mbd_server/setup/placement.hpp"

namespace tandem::mbd {
namespace {

using scene::JointType;

Error wrong_joint(std::size_t j, const scene::Joint& joint, const std::string& what,
                  const std::string& hint) {
  return Error(ErrorCode::scene, "joint \"" + joint.name + "\" " + what,
               "mbd.joints[" + std::to_string(j) + "]", hint);
}

// Rigid bodies that move as one.
struct Weld {
  double mass = 0;
  Vector3d com = Vector3d::Zero();      // world at zero coordinates [m]
  Matrix3d inertia = Matrix3d::Zero();  // about com, world axes at zero coordinates [kg m2]
};

// Inertia J about the body's own centre, transformed to a point at distance d.
Matrix3d moved(const Matrix3d& J, double mass, const Vector3d& d) {
  return J - mass * skew(d) * skew(d);
}

// One elementary joint of a chain.
struct Elemental {
  Elementary kind;
  Vector3d axis = Vector3d::UnitZ();
  double pitch = 0;
};

// The elementary joints of a joint, from the parent to the child.
std::vector<Elemental> chain(const scene::Joint& joint) {
  const Vector3d n = to_eigen(joint.axis).normalized(), across = n.unitOrthogonal();
  switch (joint.type) {
    case JointType::revolute:
      return {{Elementary::revolute, n}};
    case JointType::prismatic:
      return {{Elementary::prismatic, n}};
    case JointType::screw:
      return {{Elementary::screw, n, joint.pitch}};
    case JointType::spherical:
      return {{Elementary::spherical}};
    case JointType::cylindrical:
      return {{Elementary::prismatic, n}, {Elementary::revolute, n}};
    case JointType::universal:
      return {{Elementary::revolute, n}, {Elementary::revolute, to_eigen(joint.axis2).normalized()}};
    case JointType::planar:
      return {{Elementary::prismatic, across},
              {Elementary::prismatic, n.cross(across)},
              {Elementary::revolute, n}};
    case JointType::fixed:
    case JointType::free:
    case JointType::distance:
      break;
  }
  return {};
}

// The same joint as seen from the child: (J1 J2)^-1 = J2^-1 J1^-1, and the inverse of a rotation or a
// translation is that about or along the negated axis.
std::vector<Elemental> reversed(std::vector<Elemental> joints) {
  std::reverse(joints.begin(), joints.end());
  for (Elemental& e : joints) e.axis = -e.axis;
  return joints;
}

bool has_coordinate(JointType type) {
  return type == JointType::revolute || type == JointType::prismatic || type == JointType::screw;
}

class Builder {
 public:
  Builder(const scene::Scene& scene, const std::vector<NamedMesh>& meshes)
      : scene_(scene),
        mbd_(*scene.mbd),
        meshes_(meshes),
        topology_(find_topology(scene)),
        place_{scene, topology_, {}, {}, {}, {}, {}} {}

  Model build() {
    model_.gravity = to_eigen(scene_.gravity);
    model_.links.resize(1);
    model_.outward = topology_.outward;
    place_.number_accounts(model_);
    measure();
    read_bodies();
    weld_bodies();
    for (const int b : model_.outward) grow_link(b);
    place_bodies();
    place_joints();
    number_coordinates();
    place_closures(place_, model_);
    place_contacts(place_, meshes_, model_);
    place_forces(place_, model_);
    find_boundary();
    resolve_functions();
    find_breaks();
    find_what_can_be_left_out();
    return std::move(model_);
  }

 private:
  // The joint that connects the body to its inboard body; none where the body is free.
  const scene::Joint* joint_of(int body) const {
    const int j = topology_.edges[body].joint;
    return j == none ? nullptr : &mbd_.joints[j];
  }
  Vector3d p_WB(int body) const { return to_eigen(mbd_.bodies[body].pose.p_WB); }

  void read_bodies() {
    for (std::size_t i = 0; i < mbd_.bodies.size(); ++i) {
      const scene::Body& body = mbd_.bodies[i];
      BodyOnLink b;
      b.mass = body.mass;
      b.q_LB = to_eigen(body.pose.q_WB);
      const auto& I = body.inertia;
      Matrix3d J;
      J << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2];
      const Matrix3d R = b.q_LB.toRotationMatrix();
      b.inertia = R * J * R.transpose();
      b.inboard = topology_.edges[i].inboard;
      b.joint = topology_.edges[i].joint;
      model_.bodies.push_back(b);
    }
  }

  // Joins each body with the bodies that fixed joints weld to it; the ground is weld 0.
  void weld_bodies() {
    weld_of_.assign(model_.bodies.size(), 0);
    welds_.resize(1);
    for (const int b : model_.outward) {
      const BodyOnLink& body = model_.bodies[b];
      if (joint_of(b) && joint_of(b)->type == JointType::fixed) {
        weld_of_[b] = body.inboard == none ? 0 : weld_of_[body.inboard];
        ++model_.welded;
      } else {
        weld_of_[b] = static_cast<int>(welds_.size());
        welds_.emplace_back();
      }
      Weld& weld = welds_[weld_of_[b]];
      const double mass = weld.mass + body.mass;
      const Vector3d com = (weld.mass * weld.com + body.mass * p_WB(b)) / mass;
      weld.inertia =
          moved(weld.inertia, weld.mass, weld.com - com) + moved(body.inertia, body.mass, p_WB(b) - com);
      weld.mass = mass;
      weld.com = com;
    }
    link_of_weld_.assign(welds_.size(), 0);
    place_.origins.assign(1, model_.origin);
  }

  // `inboard_point` is the joint's position on the parent link, `origin` that on the new link, in the
  // coordinates of the file.
  LinkIndex add_link(LinkIndex parent, const Elemental& joint, const Vector3d& inboard_point,
                     const Vector3d& origin, const std::string& name) {
    Link link;
    link.parent = parent;
    link.kind = joint.kind;
    link.axis = joint.axis;
    link.pitch = joint.pitch;
    link.offset = inboard_point - place_.origins[parent];
    model_.links.push_back(link);
    place_.origins.push_back(origin);
    link_names_.resize(model_.links.size());
    link_names_.back() = name;
    return static_cast<LinkIndex>(model_.links.size()) - 1;
  }

  // Adds the links and elementary joints that move body b, unless it is welded to another body.
  void grow_link(int b) {
    const scene::Joint* joint = joint_of(b);
    if (joint && joint->type == JointType::fixed) return;
    const Weld& weld = welds_[weld_of_[b]];
    const std::string of_body = " of body \"" + mbd_.bodies[b].name + "\"";
    LinkIndex last;
    if (!joint) {
      last = add_link(0, {Elementary::translation}, weld.com, weld.com, "free translation" + of_body);
      last = add_link(last, {Elementary::spherical}, weld.com, weld.com, "free rotation" + of_body);
    } else {
      const Topology::Edge& edge = topology_.edges[b];
      last = edge.inboard == none ? 0 : link_of_weld_[weld_of_[edge.inboard]];
      const Vector3d on_parent = to_eigen(joint->position);
      const Vector3d on_child = to_eigen(joint->child_position.value_or(joint->position));
      const Vector3d origin = edge.reversed ? on_parent : on_child;
      Vector3d inboard_point = edge.reversed ? on_child : on_parent;
      for (const Elemental& e : edge.reversed ? reversed(chain(*joint)) : chain(*joint)) {
        last = add_link(last, e, inboard_point, origin, "joint \"" + joint->name + "\"" + of_body);
        inboard_point = origin;
      }
      if (joint->motion) {
        if (joint->type != JointType::revolute && joint->type != JointType::prismatic)
          throw wrong_joint(static_cast<std::size_t>(edge.joint), *joint, "cannot be driven by a motion",
                            "only revolute and prismatic joints can");
        model_.links[last].motion = static_cast<int>(model_.motions.size());
        model_.links[last].account = place_.of_joint[static_cast<std::size_t>(edge.joint)];
        model_.motions.emplace_back(*joint->motion);
      }
    }
    Link& link = model_.links[last];
    link.mass = weld.mass;
    link.com = weld.com - place_.origins[last];
    link.inertia = weld.inertia;
    link_of_weld_[weld_of_[b]] = last;
  }

  void place_bodies() {
    for (int b = 0; b < std::ssize(model_.bodies); ++b) {
      BodyOnLink& body = model_.bodies[b];
      body.link = link_of_weld_[weld_of_[b]];
      body.p_LB = p_WB(b) - place_.origins[body.link];
    }
  }

  void place_joints() {
    for (std::size_t i = 0; i < mbd_.joints.size(); ++i) {
      const scene::Joint& joint = mbd_.joints[i];
      const PointOnBody at_child =
          place_.point(model_, joint.child, joint.child_position.value_or(joint.position));
      SceneJoint j;
      j.type = joint.type;
      j.parent = joint.parent == ground ? none : static_cast<int>(joint.parent.value);
      j.child = at_child.body;
      j.link = at_child.link;
      j.p_LJ = at_child.p_LP;
      if (joint.type != JointType::free) {
        const int here = static_cast<int>(i);
        j.reversed = j.parent != none && topology_.edges[j.parent].joint == here;
        const bool in_tree = j.reversed || topology_.edges[j.child].joint == here;
        if (in_tree && has_coordinate(joint.type))
          j.coordinate_link = model_.bodies[j.reversed ? j.parent : j.child].link;
      }
      model_.joints.push_back(j);
    }
  }

  // Size and origin, from the points of the file. The size is twice the largest distance from their centre,
  // so that it does not depend on the frame; or that of the largest shape by which a body touches others. The
  // origin is a multiple of a power of two of about the size: positions relative to it are exact, and a
  // machine near the world's origin keeps that origin.
  void measure() {
    std::vector<Vector3d> points;
    const auto add = [&](Vec3d p) { points.push_back(to_eigen(p)); };
    for (const auto& body : mbd_.bodies) add(body.pose.p_WB);
    for (const auto& joint : mbd_.joints) add(joint.position);
    for (const auto& force : mbd_.forces) {
      if (const auto* spring = std::get_if<scene::SpringDamper>(&force))
        add(spring->point_a), add(spring->point_b);
      if (const auto* rope = std::get_if<scene::Rope>(&force))
        for (const scene::RopePoint& point : rope->points) add(point.point);
      if (const auto* cylinder = std::get_if<scene::Cylinder>(&force))
        add(cylinder->point_a), add(cylinder->point_b);
    }
    if (points.empty()) return;
    const Vector3d first = points.front();
    Vector3d centre = Vector3d::Zero();
    for (const Vector3d& p : points) centre += (p - first) / static_cast<double>(points.size());
    centre += first;
    double radius = 0;
    for (const Vector3d& p : points) radius = std::max(radius, (p - centre).norm());
    // Where all points coincide, the radius is round-off.
    const double shape = largest_contact_shape(scene_, meshes_);
    if (radius > 1e-12 * centre.norm() || shape > 0) model_.size = std::max(2 * radius, shape);
    const double grid = std::exp2(std::ceil(std::log2(model_.size)));
    model_.origin = grid * (centre / grid).array().round().matrix();
  }

  void number_coordinates() {
    std::vector<double> scale;
    for (std::size_t i = 1; i < model_.links.size(); ++i) {
      Link& link = model_.links[i];
      if (link.motion != none) continue;
      link.q = model_.coordinates;
      link.u = model_.freedoms;
      model_.coordinates += coordinates(link.kind);
      model_.freedoms += freedoms(link.kind);
      for (int k = 0; k < freedoms(link.kind); ++k) {
        scale.push_back(rotates(link.kind) ? 1 : model_.size);
        model_.coordinate_names.push_back(link_names_[i]);
      }
    }
    model_.scale = Eigen::Map<VectorXd>(scale.data(), std::ssize(scale));
    for (std::size_t j = 0; j < model_.joints.size(); ++j)
      if (mbd_.joints[j].rate != 0 && model_.joints[j].coordinate_link != none)
        model_.held.push_back(model_.links[model_.joints[j].coordinate_link].u);
    // A rate that is not zero is given by the scene.
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
      const LinkIndex link = model_.bodies[b].link;
      if (joint_of(static_cast<int>(b))) continue;
      const Twist& twist = mbd_.bodies[b].twist;
      if (!to_eigen(twist.v_WB).isZero(0)) model_.held.push_back(model_.links[model_.links[link].parent].u);
      if (!to_eigen(twist.w_WB).isZero(0)) model_.held.push_back(model_.links[link].u);
    }
  }

  void find_boundary() {
    for (const scene::Wall& wall : scene_.walls())
      if (wall.body != ground) model_.boundary.push_back(static_cast<int>(wall.body.value));
    std::sort(model_.boundary.begin(), model_.boundary.end());
    model_.boundary.erase(std::unique(model_.boundary.begin(), model_.boundary.end()), model_.boundary.end());
  }

  // The longest step that the run takes.
  double longest_step() const {
    double longest = scene_.coupling.window;
    if (scene_.coupling.adaptive) longest = std::max(longest, scene_.coupling.adaptive->max_window);
    return std::min(longest, mbd_.integrator.step.value_or(longest));
  }

  // Functions of time that are faster than the steps.
  void resolve_functions() {
    using Use = MotionFunction::Use;
    const double step = longest_step();
    const auto steps = mbd_.integrator.method == scene::IntegrationMethod::dormand_prince
                           ? MotionFunction::Steps::of_high_order
                           : MotionFunction::Steps::trapezoidal;
    for (const Link& link : model_.links)
      if (link.motion != none)
        model_.motions[static_cast<std::size_t>(link.motion)].resolve(step, steps, Use::coordinate,
                                                                      rotates(link.kind) ? 1 : model_.size);
    for (std::size_t i = 0; i < model_.drives.size(); ++i)
      model_.drives[i].resolve(step, steps, model_.drive_is_force[i] ? Use::force : Use::signal, HUGE_VAL);
  }

  void find_breaks() {
    std::vector<double>& breaks = model_.breaks;
    const auto add = [&](const MotionFunction& function) {
      breaks.insert(breaks.end(), function.breaks().begin(), function.breaks().end());
    };
    for (const MotionFunction& motion : model_.motions) add(motion);
    for (const MotionFunction& drive : model_.drives) add(drive);
    std::erase_if(breaks, [](double t) { return t <= time_resolution(0); });
    std::sort(breaks.begin(), breaks.end());
  }

  void find_what_can_be_left_out() {
    model_.driven = !model_.motions.empty();
    model_.damped =
        std::any_of(model_.joint_forces.begin(), model_.joint_forces.end(),
                    [](const JointForce& f) {
                      return f.viscous.present() || f.friction ||
                             (f.limits && (f.limits->damping != 0 || f.limits->restitution.value_or(1) < 1));
                    }) ||
        std::ranges::any_of(model_.forces, [](const auto& f) { return f->dissipates(); }) ||
        !model_.contact.empty();
    model_.powered = !model_.drives.empty() || model_.inputs > 0 ||
                     std::ranges::any_of(model_.forces, [](const auto& f) { return f->gives_energy(); }) ||
                     std::any_of(model_.joint_forces.begin(), model_.joint_forces.end(),
                                 [](const JointForce& f) { return f.over.has_value(); });
    const auto hear = [&](const MotionFunction& f) {
      model_.frequency = std::max(model_.frequency, f.frequency());
    };
    for (const MotionFunction& motion : model_.motions) hear(motion);
    for (const MotionFunction& drive : model_.drives) hear(drive);
    // Centrifugal and gyroscopic terms arise where a rotating link has another joint inboard or outboard,
    // or where a link rotates about more than one axis.
    std::vector<int> depth(model_.links.size(), 0);
    std::vector<bool> turning(model_.links.size(), false);
    model_.gyroscopic = false;
    for (std::size_t i = 1; i < model_.links.size(); ++i) {
      const Link& link = model_.links[i];
      depth[i] = depth[link.parent] + 1;
      turning[i] = turning[link.parent] || rotates(link.kind);
      if (turning[i] && (depth[i] > 1 || link.kind == Elementary::spherical)) model_.gyroscopic = true;
    }
  }

  const scene::Scene& scene_;
  const scene::Mbd& mbd_;
  const std::vector<NamedMesh>& meshes_;
  const Topology topology_;
  Placement place_;
  Model model_;
  std::vector<Weld> welds_;
  std::vector<int> weld_of_;  // per body
  std::vector<LinkIndex> link_of_weld_;
  std::vector<std::string> link_names_;
};

}  // namespace

Model build_model(const scene::Scene& scene, const std::vector<NamedMesh>& meshes) {
  if (!scene.mbd) throw Error(ErrorCode::scene, "the scene has no multibody part", "mbd");
  return Builder(scene, meshes).build();
}

State initial_state(const Model& model, const scene::Scene& scene) {
  State state;
  state.q = VectorXd::Zero(model.coordinates);
  state.u = VectorXd::Zero(model.freedoms);
  state.udot = state.a = state.udot_rate = state.u;
  state.lambda = VectorXd::Zero(model.equations);
  state.z = model.first_states;
  state.zdot = state.w = state.zdot_rate = state.z_known = VectorXd::Zero(state.z.size());
  state.inputs = VectorXd::Zero(model.inputs);
  state.loads.setZero(6, std::ssize(model.boundary));
  state.load_rates = state.loads;
  for (const Link& link : model.links)
    if (link.u != none && link.kind == Elementary::spherical) state.q[link.q] = 1;

  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const BodyOnLink& body = model.bodies[b];
    if (body.joint != none) continue;
    // Rates of the centre of mass of all bodies welded to this free body; link axes are the world's at
    // the start.
    const Link& link = model.links[body.link];
    const Twist& twist = scene.mbd->bodies[b].twist;
    const Vector3d w = to_eigen(twist.w_WB);
    state.u.segment<3>(model.links[link.parent].u) = to_eigen(twist.v_WB) + w.cross(link.com - body.p_LB);
    state.u.segment<3>(link.u) = w;
  }
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const LinkIndex link = model.joints[j].coordinate_link;
    if (link != none && model.links[link].u != none) state.u[model.links[link].u] = scene.mbd->joints[j].rate;
  }
  return state;
}

}  // namespace tandem::mbd
