#include "launch/import/proposed_joints.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

namespace tandem::launch {
namespace {

using Kind = FittingFaces::Kind;
using Eigen::Vector3d;

Vector3d eigen(Vec3d v) {
  return {v.x, v.y, v.z};
}
Vec3d plain(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

// Two directions across `axis`.
std::pair<Vector3d, Vector3d> across(const Vector3d& axis) {
  const Vector3d first = axis.unitOrthogonal();
  return {first, axis.cross(first)};
}

// Of the two directions of an axis, the one whose largest component is positive.
void make_positive(Vector3d& axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis(largest) < 0) axis = -axis;
}

// Faces of one pair of bodies. Twists are of body b relative to body a, about the middle of the faces: the
// angular velocity times `length`, which makes it a speed, and the velocity.
class Pair {
 public:
  void add(const FittingFaces& fit) { fits_.push_back(fit); }

  std::optional<ProposedJoint> joint() const {
    const bool touches =
        std::any_of(fits_.begin(), fits_.end(), [](const FittingFaces& fit) { return holds(fit); });
    return touches ? by_contact() : by_holes();
  }

 private:
  // A cylinder of less than half a turn is a fillet, which holds nothing.
  static bool holds(const FittingFaces& fit) {
    return fit.kind == Kind::plane_on_plane ||
           (fit.kind == Kind::pin_in_hole && fit.angle > 0.98 * std::numbers::pi);
  }

  // Holes that lie in line, with a pin that is not in the file, or that is another body.
  std::optional<ProposedJoint> by_holes() const {
    const auto hole = std::find_if(fits_.begin(), fits_.end(), [](const FittingFaces& fit) {
      return fit.kind == Kind::hole_on_hole && fit.angle > 1.9 * std::numbers::pi;
    });
    if (hole == fits_.end()) return {};
    return ProposedJoint{.type = "revolute",
                         .point = hole->point,
                         .axis = hole->direction,
                         .confidence = 0.3,
                         .reason = "holes in line, without a pin"};
  }

  std::optional<ProposedJoint> by_contact() const {
    std::vector<FittingFaces> faces;
    std::copy_if(fits_.begin(), fits_.end(), std::back_inserter(faces), holds);
    Vector3d middle = Vector3d::Zero();
    for (const FittingFaces& face : faces) middle += eigen(face.point) / static_cast<double>(faces.size());
    double length = 0;
    for (const FittingFaces& face : faces)
      length = std::max({length, (eigen(face.point) - middle).norm(), face.radius});
    if (length == 0) length = 1;

    // Rows w of w^T (angular velocity x length, velocity) = 0.
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    const auto forbid = [&](const Vector3d& rotation, const Vector3d& translation) {
      Eigen::Matrix<double, 6, 1> row;
      row << rotation, translation;
      normal += row * row.transpose();
    };
    for (const FittingFaces& face : faces) {
      const Vector3d axis = eigen(face.direction), arm = eigen(face.point) - middle;
      const auto [e1, e2] = across(axis);
      forbid(e1, Vector3d::Zero());
      forbid(e2, Vector3d::Zero());
      const auto hold = [&](const Vector3d& e) { forbid(arm.cross(e) / length, e); };
      if (face.kind == Kind::plane_on_plane) {
        hold(axis);
      } else {
        hold(e1);
        hold(e2);
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(normal);
    constexpr double round_off = 1e-5;  // squares of the angles within which faces fit, and more
    const Eigen::Index freedoms = (solver.eigenvalues().array() < round_off).count();
    const Eigen::Matrix<double, 6, Eigen::Dynamic> free = solver.eigenvectors().leftCols(freedoms);
    ProposedJoint joint;
    if (!classify(free, middle, length, joint)) return {};
    rate(faces, joint);
    return joint;
  }

  // Type, axis and point of the joint that has exactly these freedoms.
  static bool classify(const Eigen::Matrix<double, 6, Eigen::Dynamic>& free, const Vector3d& middle,
                       double length, ProposedJoint& joint) {
    joint.point = plain(middle);
    joint.axis = {0, 0, 1};
    if (free.cols() == 0) {
      joint.type = "fixed";
      return true;
    }
    const Eigen::JacobiSVD<Eigen::MatrixXd> rotations(free.topRows(3),
                                                      Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Index turning = (rotations.singularValues().array() > 1e-2).count();
    Vector3d axis = rotations.matrixU().col(0);
    make_positive(axis);
    if (turning == 0 && free.cols() == 1) {
      joint.type = "prismatic";
      Vector3d direction = free.col(0).tail(3).normalized();
      make_positive(direction);
      joint.axis = plain(direction);
      return true;
    }
    if (turning != 1 || free.cols() > 3) return false;
    joint.type = free.cols() == 1 ? "revolute" : free.cols() == 2 ? "cylindrical" : "planar";
    joint.axis = plain(axis);
    if (free.cols() < 3) {
      // The point of the axis that is nearest to the middle of the faces: w x v / w^2 [Featherstone2008].
      const Eigen::Matrix<double, 6, 1> twist = free * rotations.matrixV().col(0);
      const Vector3d w = twist.head(3) / length, v = twist.tail(3);
      joint.point = plain(middle + w.cross(v) / w.squaredNorm());
    }
    return true;
  }

  // docs/cad_import.md has this table.
  static void rate(const std::vector<FittingFaces>& faces, ProposedJoint& joint) {
    std::vector<FittingFaces> pins;  // of different axes
    bool from_both_sides = false;    // does any plane hold against another one?
    std::size_t planes = 0;
    double quality = 1;
    for (const FittingFaces& face : faces) {
      joint.gap = std::abs(face.gap) > std::abs(joint.gap) ? face.gap : joint.gap;
      if (face.kind == Kind::plane_on_plane) {
        ++planes;
        from_both_sides |= std::any_of(faces.begin(), faces.end(), [&](const FittingFaces& other) {
          return other.kind == Kind::plane_on_plane && dot(other.direction, face.direction) < -0.999;
        });
        continue;
      }
      const auto same = [&](const FittingFaces& pin) {
        return norm(cross(pin.direction, face.point - pin.point)) < 0.1 * pin.radius;
      };
      if (std::none_of(pins.begin(), pins.end(), same)) pins.push_back(face);
      double fit = 1;
      if (face.angle < 1.9 * std::numbers::pi) fit *= 0.8;
      if (std::abs(face.gap) > 1e-3 * face.radius) fit *= 0.9;
      if (face.share < 0.2) fit *= 0.7;
      quality = std::min(quality, fit);
    }
    const bool has_pin = !pins.empty();
    if (joint.type == "revolute")
      joint.confidence = from_both_sides ? 0.9 : 0.8;
    else if (joint.type == "cylindrical")
      joint.confidence = 0.8;
    else if (joint.type == "prismatic")
      joint.confidence = has_pin || from_both_sides ? 0.7 : 0.4;
    else if (joint.type == "fixed")
      joint.confidence = pins.size() >= 2 ? 0.8 : 0.3;
    else
      joint.confidence = 0.3;
    joint.confidence *= quality;
    joint.reason = has_pin ? fmt::format("{} pin{} in hole{}", pins.size(), pins.size() == 1 ? "" : "s",
                                         pins.size() == 1 ? "" : "s")
                           : "";
    if (planes > 0)
      joint.reason +=
          fmt::format("{}{} plane{} on plane", has_pin ? ", " : "", planes, planes == 1 ? "" : "s");
  }

  std::vector<FittingFaces> fits_;
};

}  // namespace

std::vector<ProposedJoint> proposed_joints(const std::vector<FittingFaces>& fits, const StepBodies& bodies) {
  std::map<std::pair<std::size_t, std::size_t>, Pair> pairs;
  for (FittingFaces fit : fits) {
    const std::size_t a = bodies.body_of[fit.a], b = bodies.body_of[fit.b];
    if (a == b || a == no_body || b == no_body) continue;
    if (a > b) fit.direction = -1.0 * fit.direction;  // normals out of the first body
    pairs[{std::min(a, b), std::max(a, b)}].add(fit);
  }
  std::vector<ProposedJoint> joints;
  for (const auto& [ends, pair] : pairs) {
    auto [parent, child] = ends;
    const StepBody &one = bodies.bodies[parent], &other = bodies.bodies[child];
    if (one.is_ground && other.is_ground) continue;
    std::optional<ProposedJoint> joint = pair.joint();
    if (!joint) continue;
    // The joint's coordinate is that of the child: the lighter body, unless it is fixed to the ground.
    if (other.is_ground || (!one.is_ground && other.mass.mass > one.mass.mass)) std::swap(parent, child);
    joint->parent = parent;
    joint->child = child;
    joints.push_back(*joint);
  }
  std::stable_sort(joints.begin(), joints.end(), [](const ProposedJoint& a, const ProposedJoint& b) {
    return a.confidence > b.confidence;
  });
  return joints;
}

}  // namespace tandem::launch
