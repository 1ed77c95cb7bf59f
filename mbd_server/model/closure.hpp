// Closures of loops: algebraic equations phi(q) = 0 between two links, from cut joints, distances and
// couplers. Each equation is a scalar; its multiplier lambda acts as the wrench -c lambda on b and +c lambda
// on a, so that the equation of motion reads M u' - f + G^T lambda = 0 with G = d phi / d x.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbd_server/model/indices.hpp"
#include "mbd_server/model/periodic_curve.hpp"
#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

inline constexpr int max_equations = 6;  // of one closure

enum class EquationKind {
  point,     // points a and b coincide along a direction fixed in the world    e . (p_b - p_a)
  slide,     // no displacement along a direction fixed in a                    n . (p_b - p_a)
  square,    // a direction of a and one of b are perpendicular                 u . v
  distance,  // of the two points                                               (|d|^2 - L^2) / 2 L
  screw,     // travel along n follows the angle about it                       n . d - pitch angle
  couple,    // coordinates of joints               q_b - ratio q_a, sum of factor q, q_b - cam(q_a)
};

struct Equation {
  EquationKind kind = EquationKind::point;
  Vector3d on_a = Vector3d::Zero();  // n, u in link a's axes; e in world axes, unit [-]
  Vector3d on_b = Vector3d::Zero();  // v in link b's axes [-]
  const char* what = "";             // motion that the equation prevents, in the user's words
};
constexpr bool is_torque(EquationKind kind) {
  return kind == EquationKind::square || kind == EquationKind::couple;
}
// Whether the direction of the equation's force or torque rotates with the links.
constexpr bool rotates_with_links(EquationKind kind) {
  return kind != EquationKind::point && kind != EquationKind::couple;
}

// A coordinate in a coupler of more than two joints.
struct CoupledLink {
  LinkIndex link = 0;
  double factor = 0;
};

struct Closure {
  std::string name;             // joint "x", coupler "y"
  LinkIndex a = 0, b = 0;       // couplers: the links of the two joints
  Vector3d p_a, p_b;            // points, frames of the links [m]
  Vector3d axis;                // revolute, prismatic, screw: axis in a's axes [-]
  Vector3d across_a, across_b;  // directions across the axis, equal at zero angle, axes of a and b [-]
  double reach = 1;   // largest distance from the closure's points to a joint of its loop, at the start [m]
  double length = 0;  // distance [m]
  double pitch = 0;   // screw [m/rad]
  double ratio = 0;   // coupler; of a cam the largest slope
  std::vector<CoupledLink> terms{};    // of a coupler of more than two joints; the first are a and b
  std::optional<PeriodicCurve> cam{};  // q_b over q_a
  int first = 0;                       // index of its first equation in lambda
  int account = none;                  // of a coupler, see Model::accounts
  std::vector<Equation> equations;
  std::vector<Equation> idle;  // redundant in every state, see place_closures(); they have no multipliers

  bool is_coupler() const { return equations.front().kind == EquationKind::couple; }
  int size() const { return static_cast<int>(equations.size()); }
  // Whether the direction of some force rotates with the links; such a closure has torques only.
  bool has_geometric_stiffness() const;
  bool stiffness_is_torque() const;
};

}  // namespace tandem::mbd
