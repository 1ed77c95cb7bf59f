#include <algorithm>
#include <optional>

#include "common/error.hpp"
#include "mbd_server/setup/placement.hpp"

namespace tandem::mbd {
namespace {

using scene::JointType;

// Directions of the file are as exact as its positions: equal within a tolerance.
struct Directions {
  double tolerance;  // [rad]
  bool parallel(const Vector3d& a, const Vector3d& b) const { return a.cross(b).norm() < tolerance; }
  bool perpendicular(const Vector3d& a, const Vector3d& b) const { return std::abs(a.dot(b)) < tolerance; }
};

// Adds the axes of all joints between a link and the ground; false where some joint is neither revolute nor
// prismatic.
bool collect_axes(const Model& model, LinkIndex link, std::vector<Vector3d>& turns,
                  std::vector<Vector3d>& slides) {
  for (; link != 0; link = model.links[link].parent) {
    const Link& l = model.links[link];
    if (l.kind == Elementary::revolute)
      turns.push_back(l.axis);
    else if (l.kind == Elementary::prismatic)
      slides.push_back(l.axis);
    else
      return false;
  }
  return true;
}

// The normal of the plane in which two links move: all joints between them and the ground rotate about it or
// slide across it.
std::optional<Vector3d> plane_of(const Model& model, LinkIndex a, LinkIndex b, const Directions& are) {
  std::vector<Vector3d> turns, slides;
  if (!collect_axes(model, a, turns, slides) || !collect_axes(model, b, turns, slides) || turns.empty())
    return {};
  const Vector3d n = turns.front();
  const bool in_plane =
      std::all_of(turns.begin(), turns.end(), [&](const Vector3d& t) { return are.parallel(t, n); }) &&
      std::all_of(slides.begin(), slides.end(), [&](const Vector3d& s) { return are.perpendicular(s, n); });
  return in_plane ? std::optional(n) : std::nullopt;
}

// Whether no motion in the plane changes the equation.
bool is_idle(const Equation& e, const Vector3d& normal, const Directions& are) {
  switch (e.kind) {
    case EquationKind::point:
    case EquationKind::slide:
      return are.parallel(e.on_a, normal);
    case EquationKind::square:
      return (are.parallel(e.on_a, normal) && are.perpendicular(e.on_b, normal)) ||
             (are.perpendicular(e.on_a, normal) && are.parallel(e.on_b, normal));
    default:
      return false;
  }
}

// In a planar loop the equations across the plane hold always, if they hold at all: they are redundant, their
// multipliers are zero, and leaving them out saves their cost. Assembly checks that they hold.
void leave_out_idle(Closure& c, const Vector3d& normal, const Directions& are) {
  std::vector<Equation> kept;
  for (const Equation& e : c.equations) (is_idle(e, normal, are) ? c.idle : kept).push_back(e);
  if (kept.empty()) kept.push_back(c.idle.back()), c.idle.pop_back();  // a closure has at least one equation
  c.equations = kept;
}

// The largest distance from the points of the closure to a joint of its loop, at zero coordinates.
double reach_of(const Placement& placement, const Model& model, const Closure& c) {
  const Vector3d p_a = placement.origins[c.a] + c.p_a, p_b = placement.origins[c.b] + c.p_b;
  double reach = (p_b - p_a).norm();
  const auto visit = [&](LinkIndex& link) {
    reach = std::max(reach, (placement.origins[link] - p_a).norm());
    link = model.links[link].parent;
  };
  // Links are numbered parent before child.
  for (LinkIndex a = c.a, b = c.b; a != b;) visit(a > b ? a : b);
  return reach > 1e-9 * model.size ? reach : model.size;
}

Closure frame_of(const Placement& placement, const Model& model, const scene::Joint& joint,
                 const std::optional<Vector3d>& normal, const Directions& are) {
  const PointOnBody a = placement.point(model, joint.parent, joint.position);
  const PointOnBody b = placement.point(model, joint.child, joint.child_position.value_or(joint.position));
  Closure c;
  c.name = "joint \"" + joint.name + "\"";
  c.a = a.link, c.b = b.link;
  c.p_a = a.p_LP, c.p_b = b.p_LP;
  c.axis = to_eigen(joint.axis).normalized();
  // For a joint in a planar loop, both directions are in the plane, or one is in it and the other is the
  // normal. So each equation is either idle or not.
  c.across_a = c.across_b = normal && are.perpendicular(*normal, c.axis)
                                ? Vector3d(*normal - normal->dot(c.axis) * c.axis).normalized()
                                : c.axis.unitOrthogonal();
  c.length = joint.length;
  c.pitch = joint.pitch;
  c.reach = reach_of(placement, model, c);
  return c;
}

// Three equations along the world's axes; where the joint moves in a plane whose normal is none of these
// axes, along that normal and two directions in the plane.
void add_points(Closure& c, const std::optional<Vector3d>& normal) {
  static const char* const along_world[] = {"displacement along x", "displacement along y",
                                            "displacement along z"};
  static const char* const along_plane[] = {
      "displacement across the plane", "first displacement in the plane", "second displacement in the plane"};
  const bool world = !normal || normal->cwiseAbs().maxCoeff() == 1;
  Matrix3d directions = Matrix3d::Identity();
  if (!world) directions << *normal, normal->unitOrthogonal(), normal->cross(normal->unitOrthogonal());
  for (int k = 0; k < 3; ++k)
    c.equations.push_back(
        {EquationKind::point, directions.col(k), Vector3d::Zero(), (world ? along_world : along_plane)[k]});
}

// The axis of b stays perpendicular to two directions of a.
void add_tilts(Closure& c) {
  const Vector3d second = c.axis.cross(c.across_a);
  c.equations.push_back({EquationKind::square, c.across_a, c.axis, "first tilt of the axis"});
  c.equations.push_back({EquationKind::square, second, c.axis, "second tilt of the axis"});
}

void add_slides(Closure& c) {
  c.equations.push_back(
      {EquationKind::slide, c.across_a, Vector3d::Zero(), "first displacement across the axis"});
  c.equations.push_back({EquationKind::slide, c.axis.cross(c.across_a), Vector3d::Zero(),
                         "second displacement across the axis"});
}

void add_turn(Closure& c) {
  c.equations.push_back({EquationKind::square, c.axis.cross(c.across_a), c.across_b, "turn about the axis"});
}

// At zero angles all directions of a and b coincide with those of the file, as link axes are the world's
// there.
void add_equations(Closure& c, const scene::Joint& joint, const std::optional<Vector3d>& normal) {
  switch (joint.type) {
    case JointType::fixed:
      add_points(c, normal), add_tilts(c), add_turn(c);
      break;
    case JointType::revolute:
      add_points(c, normal), add_tilts(c);
      break;
    case JointType::prismatic:
      add_slides(c), add_tilts(c), add_turn(c);
      break;
    case JointType::cylindrical:
      add_slides(c), add_tilts(c);
      break;
    case JointType::screw:
      add_slides(c), add_tilts(c);
      c.equations.push_back(
          {EquationKind::screw, c.axis, Vector3d::Zero(), "travel that the turn does not make"});
      break;
    case JointType::universal:
      add_points(c, normal);
      c.equations.push_back({EquationKind::square, c.axis, to_eigen(joint.axis2).normalized(), "twist"});
      break;
    case JointType::spherical:
      add_points(c, normal);
      break;
    case JointType::planar:
      c.equations.push_back({EquationKind::slide, c.axis, Vector3d::Zero(), "displacement along the normal"});
      add_tilts(c);
      break;
    case JointType::distance:
      c.equations.push_back({EquationKind::distance, Vector3d::Zero(), Vector3d::Zero(), "change of length"});
      break;
    case JointType::free:
      break;
  }
}

// The link of a joint's coordinate. A cylindrical joint is a displacement followed by an angle, or, seen from
// the child, the other way round.
LinkIndex link_of(const Model& model, const scene::CoupledJoint& coupled) {
  const SceneJoint& joint = model.joints[coupled.joint.value];
  if (joint.type != scene::JointType::cylindrical) return joint.coordinate_link;
  const LinkIndex last = model.bodies[joint.reversed ? joint.parent : joint.child].link;
  const bool is_last = (coupled.coordinate == scene::JointCoordinate::angle) != joint.reversed;
  return is_last ? last : model.links[last].parent;
}

Closure coupler_of(const Model& model, const scene::Scene& scene, std::size_t k) {
  const scene::Coupler& coupler = scene.mbd->couplers[k];
  Closure c;
  c.name = "coupler \"" + coupler.name + "\"";
  c.equations.push_back({EquationKind::couple, Vector3d::Zero(), Vector3d::Zero(), "slip"});
  if (coupler.terms.empty()) {
    c.a = model.joints[coupler.joint_a.value].coordinate_link;
    c.b = model.joints[coupler.joint_b.value].coordinate_link;
    c.ratio = coupler.ratio;
    return c;
  }
  c.a = link_of(model, coupler.terms[0]), c.b = link_of(model, coupler.terms[1]);
  if (coupler.table) {
    c.cam.emplace(coupler.table->arguments, coupler.table->values, coupler.table->period,
                  PeriodicCurve::Smoothness::curvature);
    c.ratio = c.cam->largest_slope();
  } else if (coupler.terms.size() == 2) {
    c.ratio = -coupler.terms[0].factor / coupler.terms[1].factor;
  } else {
    for (const scene::CoupledJoint& term : coupler.terms)
      c.terms.push_back({link_of(model, term), term.factor});
  }
  return c;
}

}  // namespace

void place_closures(const Placement& placement, Model& model) {
  const scene::Mbd& mbd = *placement.scene.mbd;
  const Directions are{mbd.integrator.assembly_tolerance};
  for (const int j : placement.topology.cuts) {
    const scene::Joint& joint = mbd.joints[j];
    if (joint.motion)
      throw Error(ErrorCode::scene, "joint \"" + joint.name + "\" is driven, but closes a loop",
                  "mbd.joints[" + std::to_string(j) + "]", "let another joint of the loop be cut");
    const std::optional<Vector3d> normal =
        plane_of(model, placement.link_of(model, joint.parent), placement.link_of(model, joint.child), are);
    Closure c = frame_of(placement, model, joint, normal, are);
    add_equations(c, joint, normal);
    if (normal) leave_out_idle(c, *normal, are);
    model.joints[j].closure = static_cast<int>(model.closures.size());
    model.closures.push_back(c);
  }
  for (std::size_t k = 0; k < mbd.couplers.size(); ++k) {
    model.closures.push_back(coupler_of(model, placement.scene, k));
    model.closures.back().account = placement.of_coupler[k];
  }

  for (Closure& c : model.closures) {
    c.first = model.equations;
    model.equations += c.size();
    for (const Equation& e : c.equations) model.force_arm.push_back(is_torque(e.kind) ? model.size : 1);
  }
}

}  // namespace tandem::mbd
