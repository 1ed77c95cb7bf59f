// The scene in the form that the solvers use: one struct per JSON object, names resolved to indices, SI
// units. scene/schema.json describes the file; scene/parse.hpp reads it. docs/scene_format.md is the user's
// page. A base XKeys has the numbers of object x of the schema, with unit and default (keys.hpp, generated).
//
// Positions, axes and orientations are given in the world at the start of the run unless a line says
// otherwise. A body's frame B has its origin at the centre of mass; with orientation (1,0,0,0) its axes are
// the world's.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/ids.hpp"
#include "common/math/rotation.hpp"
#include "common/scene/keys.hpp"
#include "common/scene/model_contact.hpp"
#include "common/scene/model_forces.hpp"
#include "common/scene/model_joints.hpp"
#include "common/scene/model_motion.hpp"
#include "common/scene/model_output.hpp"
#include "common/scene/model_particles.hpp"
#include "common/scene/model_shapes.hpp"
#include "common/scene/model_sph.hpp"

namespace tandem::scene {

// ---- coupling

enum class Scheme { parallel, mbd_first, dem_first, linear_implicit, implicit };
// The load on the bodies, made from the load that the particles recorded over a window: its time mean; a load
// that is linear in time with the same mean and first moment; or the value at the window's end, held (as
// other codes do).
enum class LoadShape { mean, linear, end };
// Prediction of the path prescribed to the particles: velocity held, or acceleration held as well.
enum class PathShape { linear, quadratic };

// How scheme `implicit` computes the next iterate of the path.
enum class Acceleration { constant, aitken, iqn_ils };
struct Iteration : IterationKeys {
  Acceleration method = Acceleration::iqn_ils;
};

// The window adapts to the error; that of `Coupling` is the first one.
struct Adaptive : AdaptiveKeys {};

struct Coupling {
  Scheme scheme = Scheme::dem_first;
  double window = 1e-3;  // macro step H [s], a whole number of nanoseconds
  LoadShape load = LoadShape::mean;
  PathShape path = PathShape::linear;
  std::optional<Iteration> iteration;  // scheme `implicit`; absent: as above
  std::optional<Adaptive> adaptive;    // absent: every window is `window`
};

// ---- mbd

// How the equations of closed loops are integrated (docs/mbd_time_integration.md).
enum class Formulation { index2, index3 };

// generalized_alpha is implicit and for all machines, dormand_prince explicit and for trees without stiff
// parts.
enum class IntegrationMethod { generalized_alpha, dormand_prince };

// Configuration of the start: that of the scene, or the static equilibrium near it (docs/mbd.md).
enum class Start { given, equilibrium };

struct Integrator : IntegratorKeys {
  IntegrationMethod method = IntegrationMethod::generalized_alpha;
  Formulation formulation = Formulation::index2;
};

struct Mbd {
  std::string server;                       // command of a solver that replaces ours; empty: ours
  std::vector<std::string> solver_options;  // keys; the values are in the scene's text, for that solver
  Integrator integrator;
  Start start = Start::given;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Coupler> couplers;
  std::vector<Force> forces;
  // Columns of the results that a controller receives at each window's begin.
  std::vector<std::string> sensors;
};

struct Scene {
  std::string format;  // "1.0" or "1.1"
  std::string name;
  std::string description;
  Vec3d gravity{0, 0, -9.81};  // [m/s2]
  double end_time = 0;         // [s]
  Coupling coupling;
  std::optional<Mbd> mbd;
  std::optional<Dem> dem;
  std::optional<Sph> sph;
  // Those of dem.walls, then those of sph.walls, then those of the bodies; the walls of both follow from
  // them.
  std::vector<Shape> shapes;
  std::optional<BodyContact> contact;  // of mbd.contact; absent: bodies do not touch each other
  bool is_plain = true;                // the text is the one for the solvers (common/scene/plain_text.hpp)
  Output output;
  std::vector<Check> checks;

  // Whether particles exert loads on bodies: a solver of grains, of a liquid, or both.
  bool has_particles() const { return dem || sph; }
  // The walls of all particle solvers; one that is of several of them, by its name, is there once.
  std::vector<Wall> walls() const;
  // The smallest box that contains the domains of all particle solvers; there is one.
  Box domain() const;

  // Name of a body, "ground" for the inertial frame.
  const std::string& body_name(BodyId id) const;
};

}  // namespace tandem::scene
