// Machine elements: motors on a joint coordinate, cylinders between two points. Each is a scalar law of one
// argument, the coordinate of a joint or the distance of two points, and of its rate. A law may have up to
// two states of first order, which depend on nothing but that argument and time: the solver eliminates them
// inside the element (forces/element_force.hpp).
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <variant>

#include "common/scene/model.hpp"
#include "mbd_server/model/force_law.hpp"
#include "mbd_server/model/indices.hpp"
#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

struct PointOnBody {
  int body = none;  // body of the scene; none: ground
  LinkIndex link = 0;
  Vector3d p_LP = Vector3d::Zero();  // link frame [m]
};

// A value that a function of time or a controller gives.
struct Signal {
  int drive = none;  // index in Model::drives
  int input = none;  // index in State::inputs
};

// A force that follows its signal: PI or PID control of the argument or of its rate, or the signal itself.
struct Drive {
  enum class Of { position, rate, force } of = Of::force;
  // Per error of the argument [1] or of its rate, its integral and its derivative.
  double proportional = 0, integral = 0, derivative = 0;
  double filter = 0;       // time constant of the derivative [s]; 0: none
  double anti_windup = 0;  // time constant by which a limited force draws the integral back [s]
  double limit = std::numeric_limits<double>::infinity();  // of the force
  // Torque at the motor's shaft over its speed [N m], [rad/s]: for a signal the torque at signal 1, else the
  // limit at either direction.
  ForceLaw curve;
  double gear = 1;  // speed of the shaft over the rate [-]

  bool has_integral() const { return integral != 0; }
  bool has_filter() const { return filter > 0 && derivative != 0; }
};

// Two chambers and a valve; pressures relative to the atmosphere. The states are the pressures of chamber a,
// which extends the cylinder, and of chamber b.
struct Hydraulics {
  double area_a = 0, area_b = 0;                          // of the piston [m2]
  double volume = 0;                                      // dead volume of each chamber [m3]
  double lower = 0, upper = 0;                            // strokes at which only the dead volume is left [m]
  double modulus = 0;                                     // bulk modulus [Pa]
  double supply = 0, tank = 0;                            // [Pa]
  double pump = std::numeric_limits<double>::infinity();  // largest flow of the supply [m3/s]
  double flow = 0, drop = 1;  // of one fully open edge: flow [m3/s] at a pressure drop [Pa]
  double laminar = 0;         // pressure drop below which the flow is laminar [Pa]
  double leakage = 0;         // across the piston [m3/(s Pa)]
  double cavitation = 0;      // below this pressure the law is not valid [Pa]
};

struct Element {
  std::string name;       // motor "x", cylinder "y"
  LinkIndex link = none;  // of a motor: the link whose coordinate it drives; none: a cylinder
  PointOnBody a, b;       // of a cylinder
  double length = 0;      // of a cylinder at stroke 0 [m]
  Signal signal;          // target, throttle, force or opening of the valve
  std::variant<Drive, Hydraulics> law;
  double rotor = 0;    // inertia of a motor's rotor, as felt by the coordinate [kg m2]
  double damping = 0;  // [N s/m]
  std::optional<scene::Friction> friction;
  Signal brake;  // share of the friction that acts; without a signal all of it
  std::optional<scene::Limits> ends;
  int state = 0, states = 0;  // first of its states, and how many
  int account = none;         // see Model::accounts

  bool is_cylinder() const { return link == none; }
};

}  // namespace tandem::mbd
