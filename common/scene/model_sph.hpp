// The liquid of a scene, for a solver by smoothed particle hydrodynamics. docs/liquid.md is the user's page.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/scene/keys.hpp"
#include "common/scene/model_shapes.hpp"

namespace tandem::scene {

// Pressure at the start: that of the weight of the liquid above, or none.
enum class StartPressure { hydrostatic, zero };

// The inside of a wall up to a level. Exactly one of level, volume and mass is given.
struct LiquidInside {
  std::string wall;              // name
  std::optional<double> level;   // distance above the world's origin, against gravity [m]
  std::optional<double> volume;  // [m3]
  std::optional<double> mass;    // [kg]
};

struct Liquid {
  std::string name;
  double density = 0;    // [kg/m3]
  double viscosity = 0;  // dynamic [Pa s]
  // Speed of sound of the computation [m/s]; absent: ten times the largest of `expected_speed`, of `velocity`
  // relative to the vessel and of the speed of a fall through the depth at the start.
  std::optional<double> sound_speed;
  double expected_speed = 0;        // largest speed that the run is expected to have [m/s]
  double artificial_viscosity = 0;  // alpha of Monaghan's artificial viscosity [-]
  double shifting = 0;              // of particles that a flow moves apart [-]
  // At the start: boxes along the world's axes whose edges are whole numbers of spacings, and insides of
  // walls.
  std::vector<std::variant<Box, LiquidInside>> fill;  // may be empty where there are inlets
  std::optional<Vec3d> velocity;                      // at the start [m/s]; absent: that of the vessel
  StartPressure pressure = StartPressure::hydrostatic;
};

enum class WallFriction { no_slip, free_slip };
// Of a liquid and the walls of a body, in place of Sph::wall_friction.
struct LiquidPair {
  std::string liquid;
  BodyId body = ground;
  WallFriction wall_friction = WallFriction::no_slip;
};

struct RectangleShape {
  double x = 0, y = 0;  // edges [m]
};

// What the solver of the liquid measures. Columns of sensors.csv. Of a load `wall` is the wall that it acts
// on, or all walls of the body, and the position of the pose is the point that its torques are about.
struct LiquidSensor : ParticleSensor {
  enum class Kind { region, load, level, pressure };
  Kind kind = Kind::region;
  // Unit vector in the frame of the body: of a load the axis about which its torque is given, of a level the
  // line along which it is measured; absent: no such torque, and a line against gravity.
  std::optional<Vec3d> axis = {};
  // Of a pressure: the rectangle in the x-y plane of the pose on which walls are loaded; the z axis points
  // into the liquid. Absent: the pressure at the point.
  std::optional<RectangleShape> area = {};
};

struct DiscShape {
  double radius = 0;  // [m]
};
// A flat piece of the ground through which liquid comes in, centred at the pose, along the z axis of that.
// Exactly one of velocity and flow is given. Before `start` and from `end` on it is a wall.
struct LiquidInlet {
  std::string name;
  Pose pose;
  std::variant<RectangleShape, DiscShape> shape;
  std::optional<double> velocity;  // [m/s]
  std::optional<double> flow;      // [m3/s]
  double start = 0;                // [s]
  std::optional<double> end;       // [s]; absent: none

  double area() const;   // [m2]
  double speed() const;  // [m/s]
};

// "mixed": arithmetic of pairs in single precision; "double": all in double precision
enum class LiquidPrecision { mixed, full };

struct Sph : SphKeys {
  std::string server;                       // as in Mbd
  std::vector<std::string> solver_options;  // as in Mbd
  std::vector<Liquid> liquids;              // one
  WallFriction wall_friction = WallFriction::no_slip;
  LiquidPrecision precision = LiquidPrecision::mixed;
  std::vector<Wall> walls;  // without materials
  // Particles that leave it are taken out. Not given: all space, until the coordinator knows the walls.
  Box domain{{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}};
  bool domain_is_given = false;
  std::optional<BodyId> follows;  // the domain is translated with this body, and the outlets with it
  std::vector<LiquidPair> pairs;  // each body at most once
  std::vector<LiquidSensor> sensors;
  std::vector<LiquidInlet> inlets;
  std::vector<Outlet> outlets;
  std::array<bool, 3> periodic{};  // along x, y, z: particles enter again through the opposite face instead
};

}  // namespace tandem::scene
