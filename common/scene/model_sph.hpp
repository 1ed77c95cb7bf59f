// The liquid of a scene, for a solver by smoothed particle hydrodynamics. docs/liquid.md is the user's page.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/model_shapes.hpp"

namespace tandem::scene {

// Pressure at the start: that of the weight of the liquid above, or none.
enum class StartPressure { hydrostatic, zero };

struct Liquid {
  std::string name;
  double density = 0;    // [kg/m3]
  double viscosity = 0;  // dynamic [Pa s]
  // Speed of sound of the computation [m/s]; absent: ten times the largest of `expected_speed` and of the
  // speed of a fall through the depth at the start.
  std::optional<double> sound_speed;
  double expected_speed = 0;        // largest speed that the run is expected to have [m/s]
  double artificial_viscosity = 0;  // alpha of Monaghan's artificial viscosity [-]
  // At the start: boxes along the world's axes whose edges are whole numbers of spacings.
  std::vector<Box> fill;
  Vec3d velocity;  // at the start [m/s]
  StartPressure pressure = StartPressure::hydrostatic;
};

enum class WallFriction { no_slip, free_slip };
// "mixed": arithmetic of pairs in single precision; "double": all in double precision
enum class LiquidPrecision { mixed, full };

struct Sph {
  std::string server;                       // as in Mbd
  std::vector<std::string> solver_options;  // as in Mbd
  double spacing = 0;                       // edge of the cube that one particle fills [m]
  std::vector<Liquid> liquids;              // one
  WallFriction wall_friction = WallFriction::no_slip;
  LiquidPrecision precision = LiquidPrecision::mixed;
  std::optional<double> micro_step;  // longest step [s]; absent: that of the rule (docs/liquid.md)
  std::vector<Wall> walls;           // without materials
  Box domain;                        // a particle that leaves it ends the run
  std::array<bool, 3> periodic{};    // along x, y, z: particles enter again through the opposite face instead
};

}  // namespace tandem::scene
