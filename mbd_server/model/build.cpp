#include "mbd_server/model/build.hpp"

#include <algorithm>
#include <optional>

#include "common/error.hpp"

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

// Inertia J about a body's own centre, moved to a point at distance d.
Matrix3d moved(const Matrix3d& J, double mass, const Vector3d& d) {
  return J - mass * skew(d) * skew(d);
}

class Builder {
 public:
  explicit Builder(const scene::Scene& scene) : scene_(scene), mbd_(*scene.mbd) {}

  Model build() {
    model_.gravity = to_eigen(scene_.gravity);
    model_.links.resize(1);
    read_bodies();
    hang_bodies_on_joints();
    order_bodies();
    weld_bodies();
    for (const int b : model_.outward) grow_link(b);
    place_bodies();
    place_joints();
    place_forces();
    number_coordinates();
    find_boundary();
    find_what_can_be_left_out();
    return std::move(model_);
  }

 private:
  const scene::Joint* joint_of(int body) const {
    const int j = model_.bodies[body].joint;
    return j == none ? nullptr : &mbd_.joints[j];
  }
  bool is_free(int body) const { return !joint_of(body) || joint_of(body)->type == JointType::free; }
  Vector3d p_WB(int body) const { return to_eigen(mbd_.bodies[body].pose.p_WB); }

  void read_bodies() {
    for (const scene::Body& body : mbd_.bodies) {
      BodyOnLink b;
      b.mass = body.mass;
      b.q_LB = to_eigen(body.pose.q_WB);
      const auto& I = body.inertia;
      Matrix3d J;
      J << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2];
      const Matrix3d R = b.q_LB.toRotationMatrix();
      b.inertia = R * J * R.transpose();
      model_.bodies.push_back(b);
    }
  }

  void hang_bodies_on_joints() {
    for (std::size_t j = 0; j < mbd_.joints.size(); ++j) {
      const scene::Joint& joint = mbd_.joints[j];
      if (joint.child == ground)
        throw wrong_joint(j, joint, "has the ground as its child", "exchange parent and child");
      BodyOnLink& child = model_.bodies.at(joint.child.value);
      if (child.joint != none)
        throw wrong_joint(j, joint,
                          "closes a loop: body \"" + scene_.body_name(joint.child) +
                              "\" already hangs on joint \"" + mbd_.joints[child.joint].name + "\"",
                          "each body can be the child of one joint; closed loops are not supported yet");
      child.joint = static_cast<int>(j);
      // A free joint constrains nothing: its body hangs on the ground, whatever its parent.
      if (joint.parent != ground && joint.type != JointType::free)
        child.parent = static_cast<int>(joint.parent.value);
      if (joint.motion && joint.type != JointType::revolute && joint.type != JointType::prismatic)
        throw wrong_joint(j, joint, "cannot be driven by a motion", "only revolute and prismatic joints can");
    }
  }

  void order_bodies() {
    std::vector<std::vector<int>> children(model_.bodies.size());
    auto& order = model_.outward;
    for (int b = 0; b < std::ssize(model_.bodies); ++b) {
      if (model_.bodies[b].parent == none)
        order.push_back(b);
      else
        children[model_.bodies[b].parent].push_back(b);
    }
    for (std::size_t i = 0; i < order.size(); ++i)
      order.insert(order.end(), children[order[i]].begin(), children[order[i]].end());
    if (order.size() == model_.bodies.size()) return;
    int lost = 0;
    while (std::find(order.begin(), order.end(), lost) != order.end()) ++lost;
    throw wrong_joint(model_.bodies[lost].joint, *joint_of(lost),
                      "is part of a ring of joints that never reaches the ground",
                      "hang one body of the ring on the ground, or leave its joint out to make it free");
  }

  // Joins each body with the bodies that fixed joints weld to it; the ground is weld 0.
  void weld_bodies() {
    weld_of_.assign(model_.bodies.size(), 0);
    welds_.resize(1);
    for (const int b : model_.outward) {
      const BodyOnLink& body = model_.bodies[b];
      if (joint_of(b) && joint_of(b)->type == JointType::fixed) {
        weld_of_[b] = body.parent == none ? 0 : weld_of_[body.parent];
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
    origin_.assign(1, Vector3d::Zero());
  }

  LinkIndex add_link(LinkIndex parent, Elementary kind, const Vector3d& origin, const std::string& name) {
    Link link;
    link.parent = parent;
    link.kind = kind;
    link.offset = origin - origin_[parent];
    model_.links.push_back(link);
    origin_.push_back(origin);
    link_names_.resize(model_.links.size());
    link_names_.back() = name;
    return static_cast<LinkIndex>(model_.links.size()) - 1;
  }

  // The links and elementary joints that carry body b, unless it is welded to another.
  void grow_link(int b) {
    const scene::Joint* joint = joint_of(b);
    if (joint && joint->type == JointType::fixed) return;
    const Weld& weld = welds_[weld_of_[b]];
    const std::string of_body = " of body \"" + mbd_.bodies[b].name + "\"";
    LinkIndex last;
    if (is_free(b)) {
      const LinkIndex between = add_link(0, Elementary::translation, weld.com, "free translation" + of_body);
      last = add_link(between, Elementary::spherical, weld.com, "free rotation" + of_body);
    } else {
      const int parent_body = model_.bodies[b].parent;
      const LinkIndex parent = parent_body == none ? 0 : link_of_weld_[weld_of_[parent_body]];
      const Elementary kind = joint->type == JointType::revolute    ? Elementary::revolute
                              : joint->type == JointType::prismatic ? Elementary::prismatic
                                                                    : Elementary::spherical;
      last = add_link(parent, kind, to_eigen(joint->position), "joint \"" + joint->name + "\"" + of_body);
      model_.links[last].axis = to_eigen(joint->axis).normalized();
      if (joint->motion) {
        model_.links[last].motion = static_cast<int>(model_.motions.size());
        model_.motions.emplace_back(*joint->motion);
      }
    }
    Link& link = model_.links[last];
    link.mass = weld.mass;
    link.com = weld.com - origin_[last];
    link.inertia = weld.inertia;
    link_of_weld_[weld_of_[b]] = last;
  }

  void place_bodies() {
    for (int b = 0; b < std::ssize(model_.bodies); ++b) {
      BodyOnLink& body = model_.bodies[b];
      body.link = link_of_weld_[weld_of_[b]];
      body.p_LB = p_WB(b) - origin_[body.link];
    }
  }

  void place_joints() {
    for (const scene::Joint& joint : mbd_.joints) {
      SceneJoint j;
      j.type = joint.type;
      j.child = static_cast<int>(joint.child.value);
      j.link = model_.bodies[j.child].link;
      j.p_LJ = to_eigen(joint.position) - origin_[j.link];
      model_.joints.push_back(j);
      if (joint.damping != 0 && joint.type != JointType::fixed && joint.type != JointType::free)
        model_.joint_forces.push_back({j.link, 0, joint.damping, 0});
    }
  }

  PointOnBody point(BodyId body, Vec3d p) const {
    PointOnBody point;
    point.body = body == ground ? none : static_cast<int>(body.value);
    point.link = body == ground ? 0 : model_.bodies.at(body.value).link;
    point.p_LP = to_eigen(p) - origin_[point.link];
    return point;
  }

  void place_forces() {
    for (std::size_t f = 0; f < mbd_.forces.size(); ++f) {
      if (const auto* spring = std::get_if<scene::SpringDamper>(&mbd_.forces[f])) {
        model_.springs.push_back({spring->name, point(spring->body_a, spring->point_a),
                                  point(spring->body_b, spring->point_b), spring->stiffness, spring->damping,
                                  spring->length});
        continue;
      }
      const auto& torsion = std::get<scene::RotationalSpringDamper>(mbd_.forces[f]);
      const SceneJoint& joint = model_.joints.at(torsion.joint.value);
      if (joint.type != JointType::revolute)
        throw Error(ErrorCode::scene,
                    "rotational spring \"" + torsion.name + "\" acts on joint \"" +
                        mbd_.joints[torsion.joint.value].name + "\", which is not revolute",
                    "mbd.forces[" + std::to_string(f) + "]", "name a revolute joint");
      model_.joint_forces.push_back({joint.link, torsion.stiffness, torsion.damping, torsion.angle});
    }
  }

  // Largest distance in the system as the file gives it: what counts as a large translation.
  double size() const {
    std::optional<Eigen::AlignedBox3d> box;
    const auto extend = [&](Vec3d p) {
      if (!box) box.emplace();
      box->extend(to_eigen(p));
    };
    for (const auto& body : mbd_.bodies) extend(body.pose.p_WB);
    for (const auto& joint : mbd_.joints) extend(joint.position);
    for (const auto& force : mbd_.forces)
      if (const auto* spring = std::get_if<scene::SpringDamper>(&force))
        extend(spring->point_a), extend(spring->point_b);
    const double length = box ? box->diagonal().norm() : 0;
    return length > 0 ? length : 1;
  }

  void number_coordinates() {
    std::vector<double> scale;
    const double length = size();
    for (std::size_t i = 1; i < model_.links.size(); ++i) {
      Link& link = model_.links[i];
      if (link.motion != none) continue;
      link.q = model_.coordinates;
      link.u = model_.freedoms;
      model_.coordinates += coordinates(link.kind);
      model_.freedoms += link.freedoms();
      for (int k = 0; k < link.freedoms(); ++k) {
        scale.push_back(rotates(link.kind) ? 1 : length);
        model_.coordinate_names.push_back(link_names_[i]);
      }
    }
    model_.scale = Eigen::Map<VectorXd>(scale.data(), std::ssize(scale));
  }

  void find_boundary() {
    if (!scene_.dem) return;
    for (const scene::Wall& wall : scene_.dem->walls)
      if (wall.body != ground) model_.boundary.push_back(static_cast<int>(wall.body.value));
    std::sort(model_.boundary.begin(), model_.boundary.end());
    model_.boundary.erase(std::unique(model_.boundary.begin(), model_.boundary.end()), model_.boundary.end());
  }

  void find_what_can_be_left_out() {
    model_.driven = !model_.motions.empty();
    model_.damped = std::any_of(model_.joint_forces.begin(), model_.joint_forces.end(),
                                [](const JointForce& f) { return f.damping != 0; }) ||
                    std::any_of(model_.springs.begin(), model_.springs.end(),
                                [](const Spring& s) { return s.damping != 0; });
    // Centrifugal and gyroscopic terms need a turning link that carries or is carried by another joint, or
    // that turns about more than one axis.
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
  Model model_;
  std::vector<Weld> welds_;
  std::vector<int> weld_of_;  // per body
  std::vector<LinkIndex> link_of_weld_;
  std::vector<Vector3d> origin_{};  // of each link, world at zero coordinates [m]
  std::vector<std::string> link_names_;
};

}  // namespace

Model build_model(const scene::Scene& scene) {
  if (!scene.mbd) throw Error(ErrorCode::scene, "the scene has no multibody part", "mbd");
  return Builder(scene).build();
}

State initial_state(const Model& model, const scene::Scene& scene) {
  State state;
  state.q = VectorXd::Zero(model.coordinates);
  state.u = VectorXd::Zero(model.freedoms);
  state.udot = state.a = state.u;
  state.loads.setZero(6, std::ssize(model.boundary));
  for (const Link& link : model.links)
    if (link.u != none && link.kind == Elementary::spherical) state.q[link.q] = 1;

  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const BodyOnLink& body = model.bodies[b];
    const scene::Joint* joint = body.joint == none ? nullptr : &scene.mbd->joints[body.joint];
    const Link& link = model.links[body.link];
    if (!joint || joint->type == JointType::free) {
      // Rates of the centre of mass of everything welded to this body; link axes are the world's at the
      // start.
      const Twist& twist = scene.mbd->bodies[b].twist;
      const Vector3d w = to_eigen(twist.w_WB);
      state.u.segment<3>(model.links[link.parent].u) = to_eigen(twist.v_WB) + w.cross(link.com - body.p_LB);
      state.u.segment<3>(link.u) = w;
    } else if (link.u != none &&
               (joint->type == JointType::revolute || joint->type == JointType::prismatic)) {
      state.u[link.u] = joint->rate;
    }
  }
  return state;
}

}  // namespace tandem::mbd
