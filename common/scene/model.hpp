// The scene in the form that the solvers use: one struct per JSON object, names resolved to indices, SI
// units. scene/schema.json describes the file; scene/parse.hpp reads it. docs/scene_format.md is the user's
// page.
//
// Positions, axes and orientations are given in the world at the start of the run unless a line says
// otherwise. A body's frame B has its origin at the centre of mass; with orientation (1,0,0,0) its axes are
// the world's.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/ids.hpp"
#include "common/math/rotation.hpp"
#include "common/scene/model_motion.hpp"
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
struct Iteration {
  Acceleration method = Acceleration::iqn_ils;
  double relaxation = 0.1;  // relaxation factor: always, or before there is other information [-], in (0, 2)
  double tolerance = 1e-5;  // error of a path relative to the motion over the window [-]
  double length = 1e-9;     // absolute error of a path that is always accepted [m]
  int max_iterations = 50;
};

// The window adapts to the error; that of `Coupling` is the first one.
struct Adaptive {
  double energy_tolerance = 1e-3;  // energy created in a window, relative to the energy exchanged [-]
  // Distance between the path prescribed to the particles and the path taken [m].
  double path_tolerance = 1e-5;
  double min_window = 0, max_window = 0;  // [s], whole numbers of nanoseconds
};

struct Coupling {
  Scheme scheme = Scheme::dem_first;
  double window = 1e-3;  // macro step H [s], a whole number of nanoseconds
  LoadShape load = LoadShape::mean;
  PathShape path = PathShape::linear;
  std::optional<Iteration> iteration;  // scheme `implicit`; absent: as above
  std::optional<Adaptive> adaptive;    // absent: every window is `window`
};

// ---- mbd

// How the equations of closed loops are integrated (docs/mbd.md, "Time integration").
enum class Formulation { index2, index3 };

// generalized_alpha is implicit and for all machines, dormand_prince explicit and for trees without stiff
// parts.
enum class IntegrationMethod { generalized_alpha, dormand_prince };

// Configuration of the start: that of the scene, or the static equilibrium near it (docs/mbd.md).
enum class Start { given, equilibrium };

struct Integrator {
  IntegrationMethod method = IntegrationMethod::generalized_alpha;
  double rho_inf = 0.8;        // spectral radius at infinity of generalized-alpha [-], in [0, 1]
  std::optional<double> step;  // [s]; absent: one step per window. A window is divided into equal steps.
  Formulation formulation = Formulation::index2;
  bool extrapolate =
      false;  // by two runs, with steps of h and h/2 (docs/mbd.md, "Extrapolation"); fixed step only
  std::optional<double> error_tolerance;  // local error per step, relative to 1 rad and the system's size
                                          // [-]; absent: fixed step. Then `step` is the longest one.
                                          // dormand_prince always has one.
  double min_step = 1e-12;                // error control fails below this step [s]
  // Accuracy of the file's lengths (relative to the loop) and directions [rad]: assembly may move bodies by
  // this much, and equations of loops that others imply within it are redundant.
  double assembly_tolerance = 1e-4;
  double tolerance = 1e-10;  // Newton: weighted norm of the increment [-]
  int max_iterations = 20;
};

struct Body {
  std::string name;
  double mass = 0;                  // [kg] > 0
  std::array<double, 6> inertia{};  // about the centre of mass, body axes: xx yy zz xy xz yz [kg m2]
  Pose pose;                        // at the start
  Twist twist;                      // at the start; used for free bodies, others follow from their joints
  // Mass, inertia and centre of mass are not known yet: they follow from the shapes, once the meshes are
  // there (common/scene/shape_mass.hpp). Until then `pose` is that of the frame in which the shapes are.
  bool from_shapes = false;
  std::optional<Vec3d> colour = {};  // in pictures: red, green, blue from 0 to 1
  // Names of the assemblies of a CAD program that it is in, from the outermost, with / between them.
  std::string assembly = {};
};

enum class JointType {
  fixed,
  revolute,
  prismatic,
  spherical,
  free,
  cylindrical,
  universal,
  planar,
  screw,
  distance,  // two points at a constant distance: a constraint, never part of the tree
};

// A stiff one-sided spring beyond each limit: force stiffness d (1 + damping dd/dt) at depth d.
struct Limits {
  double lower = 0, upper = 0;             // [rad] or [m]
  double stiffness = 0;                    // [N m/rad] or [N/m]
  double damping = 0;                      // [s/rad] or [s/m]
  std::optional<double> restitution = {};  // of the rate, instead of the damping, which then follows from it
};

// Coulomb friction: regularised, -force tanh(rate / slip); or with stiction, which holds a joint at rest.
struct Friction {
  double force = 0;  // of a sliding joint [N m] or [N]
  double slip = 0;   // rate at which three quarters of the force act [rad/s] or [m/s]
  // Instead of `slip`: force up to which the joint stays at rest, at least `force` [N m] or [N].
  std::optional<double> breakaway = {};
};

struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  BodyId parent = ground, child;
  Vec3d position;                       // of the joint, world at the start [m]
  std::optional<Vec3d> child_position;  // of the joint on the child; absent: the same point
  Vec3d axis{0, 0, 1};                  // world at the start, unit; planar: normal of the plane
  Vec3d axis2{1, 0, 0};                 // universal: second axis, fixed in the child, across the first
  double pitch = 0;                     // screw: travel per angle [m/rad]
  double length = 0;                    // distance [m]
  double rate = 0;                   // initial coordinate rate [rad/s] or [m/s]; revolute, prismatic, screw
  double damping = 0;                // [N m s/rad] or [N s/m]; on all freedoms of the joint
  bool cut = false;                  // close a loop at this joint, instead of the automatic choice
  std::optional<Limits> limits;      // revolute and prismatic only
  std::optional<Friction> friction;  // revolute and prismatic only
  std::optional<Motion> motion;      // prescribed coordinate [rad] or [m]; revolute and prismatic only
};
// The coordinate of a revolute, prismatic or screw joint is zero in the pose that the file gives to the
// bodies. A body that no joint connects with the ground is free, or depends on a free body.

// A force law as a table: monotone cubic through the points, straight lines outside.
struct ForceTable {
  std::vector<double> arguments, values;
};

// Which coordinate of a cylindrical joint; other joints have one.
enum class JointCoordinate { angle, displacement };
struct CoupledJoint {
  JointId joint;
  JointCoordinate coordinate = JointCoordinate::angle;
  double factor = 1;
};
// A cam: one coordinate as a function of another, through points, with continuous curvature.
struct CamTable {
  std::vector<double> arguments, values;
  std::optional<double> period;  // of the argument; the table covers one
};

// Couples coordinates of joints: q_b = ratio q_a, or sum of factor q = 0, or q_b = f(q_a) - f(0).
enum class CouplerType { gear, rack_and_pinion, belt, linear, cam };
struct Coupler {
  std::string name;
  CouplerType type = CouplerType::gear;
  JointId joint_a, joint_b;
  double ratio = 1;                   // [-], rack and pinion [m/rad]
  std::vector<CoupledJoint> terms{};  // linear: two or more; cam: a, b
  std::optional<CamTable> table{};    // cam
};

// A size that is a function of the coordinate or the rate of a joint.
struct JointFunction {
  JointId joint;
  bool of_rate = false;
  ForceTable table;              // values over [rad] or [m], or [rad/s] or [m/s]
  std::optional<double> period;  // of the coordinate; the table covers one
};

// Force along the line between two points: F = stiffness (L - length) + damping dL/dt, pulling for F > 0.
struct SpringDamper {
  std::string name;
  BodyId body_a = ground, body_b = ground;
  Vec3d point_a, point_b;                         // world at the start [m]
  double stiffness = 0, damping = 0, length = 0;  // [N/m] [N s/m] [m]
  std::optional<ForceTable> table{};              // force over (L - length) instead of the stiffness [m] [N]
  std::optional<ForceTable> damping_table{};      // force over dL/dt instead of the damping [m/s] [N]
};

// Torque on a revolute joint: T = -stiffness (q - angle) - damping dq/dt on the child.
struct RotationalSpringDamper {
  std::string name;
  JointId joint;
  double stiffness = 0, damping = 0, angle = 0;  // [N m/rad] [N m s/rad] [rad]
  std::optional<ForceTable> table{};          // torque over (q - angle) instead of the stiffness [rad] [N m]
  std::optional<ForceTable> damping_table{};  // torque over dq/dt instead of the damping [rad/s] [N m]
};

// Elastic connection of two frames that coincide at the start: force and torque on b,
// -(stiffness [d; a] + damping [d'; w]), with displacement d and rotation vector a of b in the frame of a.
struct Bushing {
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
struct Motor {
  std::string name;
  JointId joint;
  MotorControl control = MotorControl::speed;
  Motion target;      // of the joint [rad/s] or [rad], or of the throttle [-]
  std::string input;  // control input that gives the target; empty: `target`
  Gains gains;
  std::optional<double> max_torque;        // of the shaft [N m]
  std::optional<ForceTable> torque_speed;  // torque of the shaft over its speed [rad/s] [N m]
  double gear_ratio = 1;                   // speed of the shaft over that of the joint [-]
  double rotor_inertia = 0;                // about the shaft's axis [kg m2]
  std::optional<Brake> brake;
};

// Pressures are relative to the atmosphere.
struct HydraulicData {
  double bore_area = 0, rod_area = 0;            // [m2]
  double dead_volume = 0;                        // of each chamber at its end of the stroke [m3]
  double bulk_modulus = 1.5e9;                   // [Pa]
  double supply_pressure = 0;                    // of the pump's relief valve [Pa]
  double tank_pressure = 0;                      // [Pa]
  std::optional<double> pump_flow;               // most that the pump gives [m3/s]
  double valve_flow = 0;                         // through one fully open edge at `valve_drop` [m3/s]
  double valve_drop = 3.5e6;                     // [Pa]
  double laminar_drop = 1e4;                     // [Pa]
  double leakage = 0;                            // across the piston [m3/(s Pa)]
  std::optional<double> pressure_a, pressure_b;  // at the start; absent: of the tank [Pa]
  double cavitation_pressure = -1e5;             // below it the law is not valid [Pa]
};

// Force along the line between two points, positive where it pushes them apart. The stroke is the distance
// less that at the start.
enum class CylinderControl { stroke, force, valve };
struct Cylinder {
  std::string name;
  BodyId body_a = ground, body_b = ground;
  Vec3d point_a, point_b;  // world at the start [m]
  CylinderControl control = CylinderControl::force;
  Motion target;      // stroke [m], force [N], or opening of the valve from -1 to 1 [-]
  std::string input;  // control input that gives the target; empty: `target`
  Gains gains;
  std::optional<double> max_force;          // with a stroke [N]
  std::optional<HydraulicData> hydraulics;  // with a valve
  double damping = 0;                       // [N s/m]
  std::optional<Friction> friction;
  std::optional<Limits> limits;  // of the stroke [m]
};

// The force of a road on a wheel, by the brush model. The wheel is the child of the joint, its centre the
// joint's point, its axle the joint's axis; ahead is axle x normal. The road is a plane, or shapes of
// BodyContact::ground that the wheel meets along -road_normal.
struct Tyre {
  std::string name;
  JointId joint;
  double radius = 0;                  // without a load [m]
  double stiffness = 0, damping = 0;  // vertical [N/m], [N s/m]
  double friction = 0;
  double slip_stiffness = 0,
         cornering_stiffness = 0;  // force over load, per slip and per tangent of the slip angle
  double relaxation_length = 0;    // along the wheel's plane [m]
  std::optional<double> lateral_relaxation_length{};  // across it; absent: the same [m]
  double rolling_resistance = 0;                      // torque over load and loaded radius
  double patch_length = 0;                            // of contact, for the aligning torque [m]
  std::vector<std::string> road{};                    // shapes of the ground; empty: the plane
  Vec3d road_point, road_normal{0, 0, 1};             // world [m], unit
};
using Force = std::variant<SpringDamper, RotationalSpringDamper, Bushing, BodyLoad, Actuator, Rope, Motor,
                           Cylinder, Tyre>;

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

// ---- dem

struct Material {
  std::string name;
  double density = 0;                   // [kg/m3]
  double young = 0;                     // [Pa]
  double poisson = 0;                   // [-]
  std::optional<double> hardness = {};  // of a wall that wears [Pa]
};

// Properties of a contact between two materials, in either order. Every pair that can be in contact is given,
// or follows from the two materials (scene/parse_pairs.cpp). Each law has its own properties;
// docs/contact_laws.md.
struct Pair {
  MaterialId a, b;
  double restitution = 1;  // [-] all but law `paper`
  double friction = 0;     // Coulomb coefficient [-]
  // law `paper` only ([MbdDem] eq. 3-4)
  double normal_stiffness = 0;      // k_n [N/m^1.5]
  double normal_damping = 0;        // c_n [N s/m^1.25]
  double tangential_stiffness = 0;  // k_t [N/m^1.5]
  double tangential_damping = 0;    // c_t [N s/m^1.25]
  // law `hooke`
  double spring_stiffness = 0;         // k_n [N/m]
  double spring_ratio = 2.0 / 7.0;     // k_t/k_n [-]
  double work_of_adhesion = 0;         // law `jkr` [J/m2]
  double cohesion_energy_density = 0;  // law `sjkr` [J/m3]
  double rolling_friction = 0;         // with `rolling` [-]
  double rolling_damping = 0;          // with `rolling`, share of the critical one [-]
  double wear_coefficient = 0;         // of Archard's law; only output.wall_fields uses it [-]
};

enum class ContactLaw { hertz_mindlin, hertz_frictionless, paper, hooke, jkr, sjkr };
enum class Precision { mixed, full };  // "mixed": exact quanta, pair arithmetic float; "double": all double

struct LatticeFill {
  Vec3d min, max;                 // spheres are completely inside [m]
  std::string lattice = "cubic";  // "cubic" or "hexagonal"
  double spacing = 0;             // between centres [m], at least 2 r_max
  double jitter = 0;  // largest displacement per axis as a share of the gap (spacing - 2 r_max)/2, in [0, 1]
  std::uint64_t seed = 1;
  std::optional<std::uint64_t> count;  // stop after that number; an error when they do not fit
};
// Spheres that enter during the run, one after the other, at random positions in a box.
struct InletFill {
  Vec3d min, max;                      // the spheres lie inside [m]
  std::optional<double> rate;          // [1/s]; either this or
  std::optional<double> mass_rate;     // [kg/s]
  double start = 0;                    // time of the first one [s]
  std::optional<std::uint64_t> count;  // total; absent: until the end of the run
  std::uint64_t seed = 1;
};
struct FileFill {
  std::string file;
};  // CSV: scene/particle_file.hpp; relative to the scene's folder

// Part of the results of another run: the spheres of one of its frames.
struct RunFill {
  std::string folder;          // relative to the scene's folder
  std::optional<double> time;  // of the frame [s]; absent: of the last one
};

// Regions of a packing.
struct InsideWall {
  std::string wall;  // name
};
struct CylinderRegion {
  Vec3d from, to;     // middles of the ends, world [m]
  double radius = 0;  // [m]
};
struct AboveWall {
  std::string wall;                                   // name
  std::optional<std::array<double, 2>> min{}, max{};  // corners of a rectangle, x and y of the world [m];
                                                      // absent: wherever the wall is
  std::optional<double> height{};  // of the bed above the wall [m]; absent: up to the level
};
// The smallest convex room that has all of the walls in it.
struct BetweenWalls {
  std::vector<std::string> walls;  // names
};

// Spheres at random places of a region, as many as `count`, `mass` or `void_fraction` say.
struct PackingFill {
  std::variant<InsideWall, Box, CylinderRegion, AboveWall, BetweenWalls> region;
  std::optional<double> level;  // upper limit: distance above the world's origin, against gravity [m]
  std::optional<double> mass;   // [kg]
  std::optional<std::uint64_t> count;
  std::optional<double> void_fraction;  // [-]
  std::uint64_t seed = 1;
};

// Distributions of the sizes of spheres.
struct ListedSizes {
  std::vector<double> radius;         // [m]
  std::vector<double> mass_fraction;  // [-], of each radius; the sum is 1
};
struct SieveCurve {
  std::vector<double> size;     // openings, which are diameters, ascending [m]
  std::vector<double> passing;  // cumulative mass that passes, from 0 to 1 [-]
};
// By number, cut off at min and max.
struct NormalSizes {
  double mean = 0, deviation = 0, min = 0, max = 0;  // radii [m]
};
struct LogNormalSizes {
  double median = 0, min = 0, max = 0;  // radii [m]
  double deviation = 0;                 // of the natural logarithm of the radius [-]
};
using Sizes = std::variant<ListedSizes, SieveCurve, NormalSizes, LogNormalSizes>;

struct ParticleGroup {
  std::string name;
  MaterialId material;
  // Uniform between the two [m]; both 0: the radii are in a FileFill's file. With `sizes` the limits of
  // those.
  double radius_min = 0, radius_max = 0;
  std::optional<Sizes> sizes;
  Vec3d velocity;      // initial [m/s]
  bool fixed = false;  // its spheres never move: they are walls of the ground
  std::variant<LatticeFill, FileFill, InletFill, PackingFill, RunFill> fill;
};

// ---- contact between bodies

// Of a surface that bodies touch with. It has a stiffness, for all shapes, or Young's modulus and Poisson's
// ratio, for spheres by Hertz's law.
struct ContactMaterial {
  std::string name;
  std::optional<double> stiffness;  // of one point of contact [N/m]
  double young = 0, poisson = 0;    // [Pa], [-]
  double restitution = 1;           // [-], at least 0.01
  double friction = 0;              // Coulomb coefficient [-]
  double rolling_friction = 0;      // largest rolling moment over R* N, as dem.materials has it [-]
};

// Values of a contact between two materials, in either order, in place of those that follow from the two.
struct ContactMaterialPair {
  int a = 0, b = 0;  // indices of the materials
  std::optional<double> stiffness, restitution, friction, rolling_friction;
};

// A body or the ground with all of its shapes of contact, or one of these shapes.
struct ContactSide {
  BodyId body = ground;
  std::string shape;  // empty: all of them
};

// Forces of contacts that are results: what `from` does to `on` (common/scene/element_columns.hpp).
struct ContactOutput {
  std::string name;
  std::vector<ContactSide> on;    // one or more; torques are about the first one's centre of mass
  std::vector<ContactSide> from;  // empty: all that is not `on`
};

enum class Impacts {
  resolved,     // steps end where contacts begin and end, and an impact takes many of them
  within_steps  // contacts begin and end within steps, which are as long as without them
};

struct BodyContact {
  Impacts impacts = Impacts::resolved;  // of shapes that are no meshes
  std::vector<ContactMaterial> materials;
  std::vector<ContactMaterialPair> pairs;
  std::vector<Shape> ground;                  // shapes fixed to the ground
  std::vector<std::array<BodyId, 2>> ignore;  // bodies that pass through each other
  std::vector<ContactOutput> outputs;
};

// Whether a shape of contact belongs to the side.
inline bool is_of(const Shape& shape, const ContactSide& side) {
  return shape.body == side.body && (side.shape.empty() || shape.name == side.shape);
}
// Whether a contact of these two shapes is computed, in either order.
bool contact_is_computed(const Geometry& a, const Geometry& b);
// Values of a pair of materials: the given ones; else a geometric mean of restitution and friction, and a
// harmonic mean of the stiffness, where both materials have one.
ContactMaterialPair combined(const BodyContact& contact, int a, int b);

// The spheres come to rest before the start, with all walls at rest.
struct Settle {
  double kinetic_energy = 0;  // the end: mean of the spheres below it [J]
  double at_most = 10;        // of simulated time [s]
};

// Two materials without a pair that have some constants of the contact law, but not all.
struct IncompletePair {
  MaterialId a, b;
  std::string missing, by;   // key that materials or a pair can have, what needs it
  bool of_materials = true;  // false: only a pair can have the key
};

struct Dem {
  std::string server;                       // as in Mbd
  std::vector<std::string> solver_options;  // as in Mbd
  std::vector<Material> materials;
  std::vector<Pair> pairs;
  std::vector<IncompletePair> incomplete_pairs;
  ContactLaw contact = ContactLaw::hertz_mindlin;
  bool rolling = false;        // rolling resistance: an elastic-plastic spring and a dashpot
  bool twisting = false;       // torsional resistance: about the normal
  bool force_generic = false;  // use the generic kernel even where a specialised one exists
  Precision precision = Precision::mixed;
  std::optional<double> micro_step;  // [s]; absent: a fraction of the critical time
  bool auto_step = false;            // limits the step also by the duration of the fastest expected collision
  bool relax_start = false;          // separate spheres that overlap at the start
  double overlap_limit = 0.05;       // relative to the smaller radius; windows that exceed it are counted [-]
  std::optional<double> speed_limit;  // of spheres; windows that exceed it are counted [m/s]
  std::optional<double> skin;         // Verlet skin [m]; absent: chosen by the solver
  std::vector<ParticleGroup> particles;
  std::optional<Settle> settle;
  std::vector<Wall> walls;
  std::vector<Outlet> outlets;
  std::vector<ParticleSensor> sensors;
  Box domain;                      // particles that leave it are removed and counted as lost
  std::array<bool, 3> periodic{};  // along x, y, z: particles enter again through the opposite face instead
  std::optional<BodyId> follows;   // the domain is translated with this body; it does not rotate
};

// ---- output and checks

struct Camera {
  Vec3d eye, target, up{0, 0, 1};
  double field_of_view = 40;
};  // [m] [m] [-] [deg]

// What frames have of the spheres besides position, velocity, spin and radius: a column for each.
enum class SphereField { group, material, contact_count, mean_stress };
inline constexpr std::array<std::string_view, 4> sphere_field_names{"group", "material", "contact_count",
                                                                    "mean_stress"};

struct Output {
  double frame_interval = 0;     // particle and body frames [s]; 0: first and last only
  bool particles = true;         // whether frames contain the spheres
  std::optional<Camera> camera;  // of the picture of the last frame; absent: chosen from the domain
  // Columns of the CSV files that the report draws, with * for any characters; empty: the report chooses.
  std::vector<std::string> plots = {};
  std::vector<SphereField> fields = {};       // of the spheres in frames, each once
  std::vector<std::string> wall_fields = {};  // walls whose triangles have fields in frames
  std::vector<BodyId> contacts = {};          // bodies whose contacts with spheres are in frames
  bool dissipation = false;                   // whether the summary has the energy that contacts dissipate

  bool has(SphereField field) const { return std::ranges::find(fields, field) != fields.end(); }
  // Whether frames have fields that only the particle solver knows.
  bool needs_contacts() const { return has(SphereField::contact_count) || has(SphereField::mean_stress); }
  // Whether contacts are evaluated for frames.
  bool evaluates_contacts() const { return needs_contacts() || !contacts.empty(); }
};

// A pass/fail figure of the run. `of` names a time signal "<column>" of bodies.csv, joints.csv or
// elements.csv, for instance "box.contact_force.z" or "hinge.q", or a number of summary.json as
// "summary.lost_particles". `reduce` computes one number from the part from..to of the signal.
struct Check {
  std::string name, of;
  // Last, mean, rms, mean_abs, min, max, range, period (mean distance of upward crossings of the mean).
  std::string reduce = "last";
  double from = 0, to = 0;  // [s]; to = 0 means the end
  double expected = 0;      // with expected_of: filled in by the evaluation
  std::string expected_of;  // another signal or number, reduced in the same way; empty: `expected` is given
  double times = 1;         // factor of that one
  double tolerance = 0;     // relative to |expected| unless absolute
  bool absolute = false;
  std::string why;  // the formula or the source of `expected`
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
