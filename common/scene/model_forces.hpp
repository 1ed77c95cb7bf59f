// Force elements of a machine: one struct for each type of mbd.forces.
//
// A new type has the functions read(), validate(), channels() and figures() as members, which a file of
// common/scene/forces/ defines: nothing else in common/ and launch/ has to know it, where its members have
// the names of those here (name, body_a, point_a, body_b, point_b, joint, stiffness, damping).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/scene/keys.hpp"
#include "common/scene/model_joints.hpp"

namespace tandem::scene {

class Node;
class Names;
enum class Channel;
struct Mbd;

// A size that is a function of the coordinate or the rate of a joint.
struct JointFunction {
  JointId joint;
  bool of_rate = false;
  ForceTable table;              // values over [rad] or [m], or [rad/s] or [m/s]
  std::optional<double> period;  // of the coordinate; the table covers one
};

// Force along the line between two points: F = stiffness (L - length) + damping dL/dt, pulling for F > 0.
struct SpringDamper {
  static constexpr const char* type = "spring_damper";
  std::string name;
  BodyId body_a = ground, body_b = ground;
  Vec3d point_a, point_b;                         // world at the start [m]
  double stiffness = 0, damping = 0, length = 0;  // [N/m] [N s/m] [m]
  std::optional<ForceTable> table{};              // force over (L - length) instead of the stiffness [m] [N]
  std::optional<ForceTable> damping_table{};      // force over dL/dt instead of the damping [m/s] [N]
};

// Torque on a revolute joint: T = -stiffness (q - angle) - damping dq/dt on the child.
struct RotationalSpringDamper {
  static constexpr const char* type = "rotational_spring_damper";
  std::string name;
  JointId joint;
  double stiffness = 0, damping = 0, angle = 0;  // [N m/rad] [N m s/rad] [rad]
  std::optional<ForceTable> table{};          // torque over (q - angle) instead of the stiffness [rad] [N m]
  std::optional<ForceTable> damping_table{};  // torque over dq/dt instead of the damping [rad/s] [N m]
};

// Elastic connection of two frames that coincide at the start: force and torque on b,
// -(stiffness [d; a] + damping [d'; w]), with displacement d and rotation vector a of b in the frame of a.
struct Bushing {
  static constexpr const char* type = "bushing";
  std::string name;
  BodyId body_a = ground, body_b = ground;
  Vec3d position;                      // world at the start [m]; axes of the world at the start
  std::array<double, 36> stiffness{};  // rows: force x y z [N], torque x y z [N m]; columns: [m], [rad]
  std::array<double, 36> damping{};
};

// Force or torque of given direction on a body; its size is a function of time.
struct BodyLoad {
  std::string name;
  enum class Kind { force, torque } kind = Kind::force;
  BodyId body;
  Vec3d point;                          // of a force, world at the start [m]
  Vec3d direction{0, 0, 1};             // world at the start, unit
  bool follows = false;                 // the direction rotates with the body
  Motion size;                          // [N] or [N m]
  std::optional<JointFunction> over{};  // instead of `size`
};

// Torque or force on the coordinate of a revolute or prismatic joint.
struct Actuator {
  static constexpr const char* type = "actuator";
  std::string name;
  JointId joint;
  Motion size;          // [N m] or [N]
  std::string input{};  // control input that gives the size, held over each window; empty: `size`
  std::optional<JointFunction> over{};  // instead of both
};

// A rope through eyelets, without friction: its tension, the same everywhere, is
// axial_stiffness / length * e (1 + damping de/dt) for an elongation e > 0, and it does not push.
struct RopePoint {
  BodyId body = ground;
  Vec3d point;  // world at the start [m]
};
struct Rope {
  static constexpr const char* type = "rope";
  std::string name;
  std::vector<RopePoint> points;                        // from one end to the other
  double length = 0, axial_stiffness = 0, damping = 0;  // [m] [N] [s/m]
  // Revolute joint of a drum: the rope leaves it at the first point, which is fixed to the joint's parent.
  std::optional<JointId> drum{};
};
// How a rope leaves its drum.
struct DrumLead {
  Vec3d arm;             // from the axis of the drum to the first point [m]
  double cosine = 0;     // of the angle between the rope and the surface of the drum there
  double per_angle = 0;  // length that the drum takes up per angle of its joint: its radius, with a sign [m]
};
DrumLead drum_lead(const Rope& rope, const std::vector<Joint>& joints);

// PID control of a coordinate, a rate or a stroke: force per error, its integral and its derivative. The
// derivative of a position is the rate of the target less that of the coordinate; with `filter` it is that of
// the filtered error.
struct Gains {
  double proportional = 0;  // [force or torque / error]
  double integral = 0;      // [force or torque / (error s)]
  double derivative = 0;    // [force or torque s / error]
  double filter = 0;        // time constant [s]; 0: no filter
  // Time constant with which a limited force draws the integral back [s]; absent: proportional / integral.
  std::optional<double> anti_windup{};
};

// Friction that a signal from 0 to 1 applies: -signal torque tanh(rate / slip).
struct Brake {
  double torque = 0, slip = 0;  // [N m], [rad/s]
  // Instead of `slip`: torque up to which the joint stays at rest, at least `torque` [N m].
  std::optional<double> breakaway = {};
  std::optional<Motion> engaged;  // absent: always, or as `input` says
  std::string input;              // control input that gives the share; empty: `engaged`
};

// Torque on the coordinate of a revolute joint, with a gear between shaft and joint.
enum class MotorControl { speed, position, throttle };
struct Motor : MotorKeys {
  static constexpr const char* type = "motor";
  std::string name;
  JointId joint;
  MotorControl control = MotorControl::speed;
  Motion target;      // of the joint [rad/s] or [rad], or of the throttle [-]
  std::string input;  // control input that gives the target; empty: `target`
  Gains gains;
  std::optional<ForceTable> torque_speed;  // torque of the shaft over its speed [rad/s] [N m]
  std::optional<Brake> brake;
};

// Pressures are relative to the atmosphere.
struct HydraulicData : HydraulicsKeys {};

// Force along the line between two points, positive where it pushes them apart. The stroke is the distance
// less that at the start.
enum class CylinderControl { stroke, force, valve };
struct Cylinder : CylinderKeys {
  static constexpr const char* type = "cylinder";
  std::string name;
  BodyId body_a = ground, body_b = ground;
  CylinderControl control = CylinderControl::force;
  Motion target;      // stroke [m], force [N], or opening of the valve from -1 to 1 [-]
  std::string input;  // control input that gives the target; empty: `target`
  Gains gains;
  std::optional<HydraulicData> hydraulics;  // with a valve
  std::optional<Friction> friction;
  std::optional<Limits> limits;  // of the stroke [m]
};

// The force of a road on a wheel, by the brush model. The wheel is the child of the joint, its centre the
// joint's point, its axle the joint's axis; ahead is axle x normal. The road is a plane, or shapes of
// BodyContact::ground that the wheel meets along -road_normal.
struct Tyre : TyreKeys {
  static constexpr const char* type = "tyre";
  std::string name;
  JointId joint;
  std::vector<std::string> road{};  // shapes of the ground; empty: the plane
};

// A spring of gas between two points, which it pushes apart with (p - ambient_pressure) piston_area. The gas
// obeys p (V / m)^exponent = const, with the volume V = volume + piston_area stroke and the mass m, of which
// `leakage` lets some out. The stroke is the distance of the points less that at the start. Pressures are
// absolute.
struct GasSpring : GasSpringKeys {
  static constexpr const char* type = "gas_spring";
  std::string name;
  BodyId body_a, body_b;
  std::optional<Limits> limits{};  // end stops, as strokes

  static GasSpring read(const Node& node, const Names& bodies, const Names& joints);
  void validate(const Mbd& mbd, const std::string& origin, const std::string& path) const;
  std::vector<Channel> channels() const;
  std::vector<std::string> figures() const;
};

using Force = std::variant<SpringDamper, RotationalSpringDamper, Bushing, BodyLoad, Actuator, Rope, Motor,
                           Cylinder, Tyre, GasSpring>;

}  // namespace tandem::scene
