#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/scene/nearest_name.hpp"
#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

void validate_inertia(const Body& body, const std::string& origin, const std::string& path) {
  const auto& I = body.inertia;
  Eigen::Matrix3d matrix;
  matrix << I[0], I[3], I[4], I[3], I[1], I[5], I[4], I[5], I[2];
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(matrix, Eigen::EigenvaluesOnly)
          .eigenvalues();  // ascending
  const std::string found =
      "the principal moments are " + rounded(Vec3d{moments[0], moments[1], moments[2]}) + " kg m2; ";
  // A moment that differs from zero by rounding only counts as zero.
  constexpr double rounding = 1e-12;
  if (!(moments[0] > rounding * moments[2]))
    fail(origin, path, found + "all must be positive", "check xx, yy, zz, xy, xz, yz and their units");
  // Each moment is the sum of two of the three second moments of the mass. The tolerance is for rounded
  // data of thin plates.
  constexpr double tolerance = 1e-6;
  if (moments[2] > (1 + tolerance) * (moments[0] + moments[1]))
    fail(origin, path, found + "the largest exceeds the sum of the others",
         "no rigid body has such an inertia");
}

void validate_bodies(const Mbd& mbd, const std::string& origin) {
  for (std::size_t i = 0; i < mbd.bodies.size(); ++i) {
    const Body& body = mbd.bodies[i];
    const std::string path = element("mbd.bodies", i);
    if (!body.from_shapes) validate_inertia(body, origin, path + ".inertia");
    require_unit(body.pose.q_WB, origin, path + ".orientation");
  }
}

void validate_connections(const Mbd& mbd, const std::string& origin) {
  std::vector<const Joint*> joint_of(mbd.bodies.size(), nullptr);
  for (std::size_t i = 0; i < mbd.joints.size(); ++i) {
    const Joint& joint = mbd.joints[i];
    if (joint.parent == joint.child)
      fail(origin, element("mbd.joints", i) + ".child",
           "'" + mbd.bodies[joint.child.value].name + "' is parent and child of one joint",
           "a joint connects two bodies");
    if (joint.type != JointType::free && joint.type != JointType::distance && !joint.cut)
      joint_of[joint.child.value] = &joint;
  }
  for (std::size_t i = 0; i < mbd.bodies.size(); ++i) {
    const Body& body = mbd.bodies[i];
    if (!joint_of[i]) continue;
    const bool turns = norm(body.twist.w_WB) > 0;
    if (turns || norm(body.twist.v_WB) > 0)
      fail(origin, element("mbd.bodies", i) + (turns ? ".angular_velocity" : ".velocity"),
           "'" + body.name + "' gets its velocity from joint '" + joint_of[i]->name + "'",
           "leave it out; revolute and prismatic joints have a rate");
  }
}

void validate_joint(const Joint& joint, const std::string& origin, const std::string& path) {
  require_unit(joint.axis, origin, path + ".axis");
  if (joint.type == JointType::universal) {
    require_unit(joint.axis2, origin, path + ".axis2");
    if (std::abs(dot(joint.axis, joint.axis2)) > 1e-6)
      fail(origin, path + ".axis2",
           text(joint.axis2) + " is not perpendicular to the axis " + text(joint.axis),
           "the axes of a universal joint make a cross");
  }
  if (joint.type == JointType::distance && joint.position == *joint.child_position)
    fail(origin, path + ".child_position",
         "both ends are at " + text(joint.position) + ": the distance has no direction",
         "move one of the points");
  if (joint.limits && !(joint.limits->lower < joint.limits->upper))
    fail(origin, path + ".limits.upper",
         text(joint.limits->upper) + " is not above the lower limit of " + text(joint.limits->lower),
         "lower < upper");
  if (joint.friction && joint.friction->breakaway.value_or(HUGE_VAL) < joint.friction->force)
    fail(origin, path + ".friction.breakaway",
         text(*joint.friction->breakaway) + " is below the force of the sliding joint, " +
             text(joint.friction->force),
         "give that or more");
  if (joint.cut && (joint.motion || joint.rate != 0 || joint.damping != 0 || joint.limits || joint.friction))
    fail(origin, path + ".cut",
         "joint '" + joint.name +
             "' is cut, but has a motion, rate, damping, limits or friction, which act on its coordinate",
         "cut another joint of the loop");
}

void validate_joints(const Mbd& mbd, double end_time, const std::string& origin) {
  for (std::size_t i = 0; i < mbd.joints.size(); ++i) {
    validate_joint(mbd.joints[i], origin, element("mbd.joints", i));
    if (mbd.joints[i].motion)
      validate_motion(mbd.joints[i], end_time, origin, element("mbd.joints", i) + ".motion");
  }
  validate_connections(mbd, origin);
}

void validate_coupled(const Coupler& coupler, const Mbd& mbd, const std::string& origin,
                      const std::string& path) {
  const bool cam = coupler.type == CouplerType::cam;
  for (std::size_t k = 0; k < coupler.terms.size(); ++k) {
    const CoupledJoint& term = coupler.terms[k];
    const Joint& joint = mbd.joints[term.joint.value];
    const std::string here = cam ? path : element(path + ".terms", k);
    const std::string key = here + (!cam ? ".joint" : (k == 0 ? ".joint_a" : ".joint_b"));
    if (joint.type != JointType::revolute && joint.type != JointType::prismatic &&
        joint.type != JointType::screw && joint.type != JointType::cylindrical)
      fail(origin, key, "joint '" + joint.name + "' has no coordinate of its own",
           "name a revolute, prismatic, screw or cylindrical joint");
    if (joint.cut)
      fail(origin, key, "joint '" + joint.name + "' is cut and has no coordinate",
           "cut another joint of the loop");
    if (term.factor == 0) fail(origin, here + ".factor", "the factor is 0", "leave the term out");
    for (std::size_t l = 0; l < k; ++l)
      if (coupler.terms[l].joint == term.joint && coupler.terms[l].coordinate == term.coordinate)
        fail(origin, key, "'" + joint.name + "' is coupled to itself", "name each coordinate once");
  }
  if (coupler.table)
    validate_curve(coupler.table->arguments, coupler.table->values, coupler.table->period, false, origin,
                   path + ".table");
}

void validate_couplers(const Mbd& mbd, const std::string& origin) {
  for (std::size_t i = 0; i < mbd.couplers.size(); ++i) {
    const Coupler& coupler = mbd.couplers[i];
    const std::string path = element("mbd.couplers", i);
    if (!coupler.terms.empty()) {
      validate_coupled(coupler, mbd, origin, path);
      continue;
    }
    const Joint &a = mbd.joints[coupler.joint_a.value], &b = mbd.joints[coupler.joint_b.value];
    const bool rack = coupler.type == CouplerType::rack_and_pinion;
    require_revolute(a, mbd, "name a revolute joint", origin, path + ".joint_a");
    if (!rack) require_revolute(b, mbd, "gears and belts join revolute joints", origin, path + ".joint_b");
    if (rack && b.type != JointType::prismatic)
      fail(origin, path + ".joint_b", "joint '" + b.name + "' is not prismatic", "a rack slides");
    if (coupler.joint_a == coupler.joint_b)
      fail(origin, path + ".joint_b", "'" + b.name + "' is coupled to itself", "name two joints");
    if (coupler.ratio == 0) fail(origin, path + ".ratio", "the ratio is 0", "give q_b / q_a");
    if (a.cut || b.cut)
      fail(origin, path + (a.cut ? ".joint_a" : ".joint_b"),
           "joint '" + (a.cut ? a : b).name + "' is cut and has no coordinate",
           "cut another joint of the loop");
  }
}

}  // namespace

void require_revolute(const Joint& joint, const Mbd& mbd, const std::string& hint, const std::string& origin,
                      const std::string& path) {
  if (joint.type == JointType::revolute) return;
  std::vector<std::string> names;
  for (const Joint& known : mbd.joints)
    if (known.type == JointType::revolute) names.push_back(known.name);
  fail(origin, path, "joint '" + joint.name + "' is not revolute",
       hint + "; " + suggest_name(joint.name, names, "revolute joints"));
}

void validate_arguments(const ForceTable& table, const std::string& origin, const std::string& path) {
  if (table.arguments.size() != table.values.size())
    fail(origin, path + ".values",
         std::to_string(table.values.size()) + " values for " + std::to_string(table.arguments.size()) +
             " arguments",
         "give one value for each argument");
  for (std::size_t k = 1; k < table.arguments.size(); ++k)
    if (!(table.arguments[k] > table.arguments[k - 1]))
      fail(origin, element(path + ".arguments", k),
           exact_text(table.arguments[k]) + " does not come after " + exact_text(table.arguments[k - 1]),
           "arguments must increase");
}

void validate_curve(const std::vector<double>& arguments, const std::vector<double>& values,
                    const std::optional<double>& period, bool closes, const std::string& origin,
                    const std::string& path) {
  if (arguments.size() != values.size())
    fail(origin, path + ".values",
         std::to_string(values.size()) + " values for " + std::to_string(arguments.size()) + " arguments",
         "give one value for each argument");
  validate_curve_arguments(arguments, period, AngleUnit::radians, origin, path);
  if (period && closes && values.front() != values.back())
    fail(origin, path + ".values",
         "the last value, " + text(values.back()) + ", differs from the first, " + text(values.front()),
         "both are at the same place of the period: give the same value");
}

void validate_curve_arguments(const std::vector<double>& arguments, const std::optional<double>& period,
                              AngleUnit unit, const std::string& origin, const std::string& path) {
  const bool degrees = unit == AngleUnit::degrees;
  const std::string suffix = degrees ? "_deg" : "", symbol = degrees ? " deg" : "";
  for (std::size_t k = 1; k < arguments.size(); ++k)
    if (!(arguments[k] > arguments[k - 1]))
      fail(
          origin, element(path + ".arguments" + suffix, k),
          exact_text(arguments[k]) + symbol + " does not come after " + exact_text(arguments[k - 1]) + symbol,
          "arguments must increase");
  if (!period) return;
  const double range = arguments.back() - arguments.front();
  constexpr double rounding = 1e-6;
  if (std::abs(range - *period) > rounding * *period)
    fail(origin, path + ".period" + suffix,
         "the arguments cover " + text(range) + symbol + ", and the period is " + text(*period) + symbol,
         "let the table begin and end one period apart");
}

void validate_mbd(const Mbd& mbd, double window, double end_time, const std::string& origin) {
  validate_bodies(mbd, origin);
  validate_joints(mbd, end_time, origin);
  validate_couplers(mbd, origin);
  validate_forces(mbd, end_time, origin);
  if (mbd.integrator.method == IntegrationMethod::dormand_prince)
    for (std::size_t i = 0; i < mbd.forces.size(); ++i)
      if (const auto* motor = std::get_if<Motor>(&mbd.forces[i]);
          motor && motor->brake && motor->brake->breakaway)
        fail(origin, "mbd.integrator.method",
             "'dormand_prince' does not hold a joint at rest, as the breakaway of " +
                 element("mbd.forces", i) + ".brake asks",
             "leave out method, which is then generalized_alpha, or give the brake a slip");
  if (mbd.integrator.method == IntegrationMethod::dormand_prince)
    for (std::size_t i = 0; i < mbd.joints.size(); ++i) {
      const Joint& joint = mbd.joints[i];
      if (joint.limits)
        fail(origin, "mbd.integrator.method",
             "'dormand_prince' does not compute the contacts of " + element("mbd.joints", i) + ".limits",
             "leave out method, which is then generalized_alpha, or leave out the limits");
      if (joint.friction && joint.friction->breakaway)
        fail(origin, "mbd.integrator.method",
             "'dormand_prince' does not hold a joint at rest, as the breakaway of " +
                 element("mbd.joints", i) + ".friction asks",
             "leave out method, which is then generalized_alpha, or give the friction a slip");
    }
  if (mbd.start == Start::equilibrium) {
    const auto at_rest = [&](const std::string& path, bool rest) {
      if (!rest)
        fail(origin, path, "it moves at the start, and an equilibrium is at rest",
             "use 0, or leave out mbd.start");
    };
    for (std::size_t i = 0; i < mbd.bodies.size(); ++i) {
      at_rest(element("mbd.bodies", i) + ".velocity", norm(mbd.bodies[i].twist.v_WB) == 0);
      at_rest(element("mbd.bodies", i) + ".angular_velocity", norm(mbd.bodies[i].twist.w_WB) == 0);
    }
    for (std::size_t i = 0; i < mbd.joints.size(); ++i)
      at_rest(element("mbd.joints", i) + ".rate", mbd.joints[i].rate == 0);
  }
  if (mbd.integrator.extrapolate && mbd.integrator.error_tolerance)
    fail(origin, "mbd.integrator.extrapolate",
         "two runs with steps of h and h/2 have no step of their own to control",
         "leave out extrapolate or error_tolerance");
  if (mbd.integrator.extrapolate)
    for (std::size_t i = 0; i < mbd.joints.size(); ++i)
      if (mbd.joints[i].limits)
        fail(origin, "mbd.integrator.extrapolate",
             "the contacts of " + element("mbd.joints", i) +
                 ".limits begin at other times in each of the two runs",
             "leave out extrapolate or the limits");
  if (mbd.integrator.extrapolate)
    for (std::size_t i = 0; i < mbd.joints.size(); ++i)
      if (mbd.joints[i].friction && mbd.joints[i].friction->breakaway)
        fail(origin, "mbd.integrator.extrapolate",
             element("mbd.joints", i) + ".friction sticks and slides at other times in each of the two runs",
             "leave out extrapolate, or give the friction a slip");
  if (mbd.integrator.extrapolate)
    for (std::size_t i = 0; i < mbd.forces.size(); ++i)
      if (const auto* motor = std::get_if<Motor>(&mbd.forces[i]);
          motor && motor->brake && motor->brake->breakaway)
        fail(origin, "mbd.integrator.extrapolate",
             element("mbd.forces", i) + ".brake sticks and slides at other times in each of the two runs",
             "leave out extrapolate, or give the brake a slip");
  if (mbd.integrator.step && *mbd.integrator.step > window)
    fail(origin, "mbd.integrator.step",
         "the step of " + text(*mbd.integrator.step) + " s is longer than the window of " + text(window) +
             " s",
         "leave it out for one step per window");
}

}  // namespace tandem::scene
