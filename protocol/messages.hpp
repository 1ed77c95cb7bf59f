// Payloads. Fixed-layout records are little-endian with alignment 8, and are copied to the wire byte by byte;
// variable parts follow the fixed head as counted arrays. Units are SI, axes are the world's.
//
// Sign: a load is the load of the particles ON the body; torque is about the body's centre of mass.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "common/error.hpp"
#include "common/geometry/triangle_mesh.hpp"
#include "common/ids.hpp"
#include "common/math/rotation.hpp"
#include "common/time.hpp"

namespace tandem::protocol {

enum class Kind : std::uint16_t {
#define MESSAGE(name, code, sender, meaning) name = code,
#include "protocol/messages.def"
#undef MESSAGE
};
const char* name(Kind kind);

// `dem` and `sph` are load solvers: motion in, loads out. Their sessions have the same messages; a run may
// have one of each.
enum class Role : std::uint32_t { mbd = 1, dem = 2, sph = 3 };
inline constexpr std::array all_roles{Role::mbd, Role::dem, Role::sph};
const char* name(Role role);  // "mbd_server", "dem_server", "sph_server"
const char* word_of(
    Role role);  // "mbd", "dem", "sph": the part of the scene, and the word of the command line

// ---- registration

// Capability bits. A coordinator refuses a participant without a bit that the run needs. Those of `dem` are
// of all load solvers.
enum Capability : std::uint64_t {
  can_predict = 1u << 0,      // mbd: answers predict
  can_rollback = 1u << 1,     // answers save and restore
  can_interpolate = 1u << 2,  // dem: follows pose and twist inside the window
  can_window_mean = 1u << 3,  // dem: returns impulse means
  can_linearise = 1u << 4,    // answers linearise; dem since 1.1, mbd since 1.4
  can_extrapolate = 1u << 5,  // mbd: answers extrapolate, integrates loads that are linear in time; since 1.1
  can_control = 1u << 6,      // mbd: answers control; since 1.2
  can_checkpoint = 1u << 7,   // answers checkpoint and resume; since 1.3
  can_observe_elements = 1u << 8,   // mbd: its bodies frames have the elements; since 1.4
  can_measure = 1u << 9,            // dem, sph: its loads have the values of its sensors; since 1.4
  can_observe_contacts = 1u << 10,  // dem: its particles frames have the contacts of spheres; since 1.4
  can_observe_walls = 1u << 11,     // dem: its particles frames have the fields of walls; since 1.4
  can_snapshot = 1u << 12,          // dem: keeps a particles frame for later; since 1.4
  can_observe_liquid = 1u << 13,    // sph: its particles frames have pressure and density; since 1.4
  can_respond = 1u << 14,           // dem, sph: its tangents have responses, also before a window; since 1.5
};

struct Hello {
  Role role{};
  std::uint64_t layout_hash = 0;
  std::uint64_t capabilities = 0;
  std::int64_t pid = 0;
  std::string program;  // "mbd_server 0.1.0"
  std::string host;
};

// ---- configuration

using tandem::NamedMesh;  // of a wall, or of a shape of contact: see common/geometry/triangle_mesh.hpp

struct NamedText {
  std::string name;  // of the particle group
  std::string text;  // its CSV file, unchanged
};

struct Configuration {
  std::string scene_text;         // JSON
  std::string origin;             // its path, for messages
  std::vector<NamedMesh> meshes;  // of the walls with a mesh file, and of shapes of contact ("BODY/SHAPE")
  std::vector<NamedText> files;   // of the particle groups with a file
  std::string backend;            // of load solvers: "auto", "cpu", "cuda"
  std::uint32_t threads = 0;      // 0: the participant chooses
};

struct BodyMotion {  // one boundary body over one window
  std::uint32_t body = 0, reserved = 0;
  Pose begin_pose, end_pose;
  Twist begin_twist, end_twist;
  Vec3d begin_a, end_a;          // acceleration of the centre of mass [m/s2]
  Vec3d begin_alpha, end_alpha;  // angular acceleration [rad/s2]
  // Effect of this body's load over the window, recorded by the MBD side; zero in a prediction.
  Wrench applied_impulse;   // sum of step * applied load [N s] [N m s]
  double applied_work = 0;  // done by the load along the path taken [J]
};

struct MotionSet {
  Window window;
  std::vector<BodyMotion> bodies;
};

struct BodyLoad {  // one boundary body (or ground) over one window
  std::uint32_t body = 0, reserved = 0;
  Wrench mean;          // time mean over the window
  Wrench first_moment;  // (1/H) integral of (t - t_mid) F dt [N s]
  Wrench end;           // at the last micro step
  double work = 0;      // done by the particles on the body along its prescribed path [J]
};

// Response of the contacts of one boundary body, with particles (dem) or with other bodies and the ground
// (mbd), to a small motion of this body alone from its present pose: dF = -stiffness dx - damping dv, with
// dx = (displacement, rotation), dv = (velocity, angular velocity), about the body's frame, world axes.
struct BodyTangent {
  std::uint32_t body = 0, reserved = 0;
  std::array<double, 36> stiffness{};  // by rows: force, torque (6 x 6)
  std::array<double, 36> damping{};    // by rows: force, torque (6 x 6)
};
// One point of the response of the load on one boundary body to a step of its velocity by dv: until `time`
// after the step the body was given the impulse -impulse dv. It begins as the radiation damping times the
// time, and ends as the added mass. About the body's frame, world axes.
struct BodyResponse {
  std::uint32_t body = 0, reserved = 0;
  double time = 0;                   // [s]
  std::array<double, 36> impulse{};  // by rows: force, torque (6 x 6)
};
struct TangentSet {
  Nanoseconds time;
  std::vector<BodyTangent> bodies;  // bodies with contacts
  // Bodies in a liquid, by body and time; straight lines between the points, from zero at no time, and the
  // last impulse for good. Empty, and then not on the wire, without can_respond.
  std::vector<BodyResponse> responses = {};
};

struct ParticleAccount {  // balance of the particles over one window, recorded by the DEM side
  std::uint64_t micro_steps = 0;
  double micro_step = 0;               // dt_eff [s]
  Vec3d momentum_begin, momentum_end;  // sum of m v [kg m/s]
  Vec3d gravity_impulse;               // [N s]
  Vec3d lost_momentum;        // momentum of particles that left, less that of particles that entered [kg m/s]
  double kinetic_energy = 0;  // at the end [J]
  double max_overlap_ratio = 0;      // largest overlap / smaller radius since the start [-]
  std::uint64_t lost_particles = 0;  // since the start
  std::uint64_t contacts = 0;        // sphere-sphere contacts at the end
  std::uint64_t rebuilds = 0;        // neighbour list builds since the start
};

struct LoadSet {
  Window window;
  ParticleAccount account;
  std::vector<BodyLoad> bodies;
  // Values of the columns of scene::sensor_columns() that are of the sender's part of the scene, at the end
  // of the window; empty, and then not on the wire, without can_measure and where that part has no sensors.
  std::vector<double> sensors = {};
};

// Values from an external controller for the actuators with an input, valid from now on.
struct ControlSet {
  Nanoseconds time;
  std::vector<double> values;  // in the order of scene::control_inputs() [N m] or [N]
};

// Answer to configure. `boundary` has the initial state of the bodies with walls (mbd), and is empty for load
// solvers. `sensors` are those of LoadSet at the start (dem, sph).
struct Configured {
  std::vector<BodyMotion> boundary;  // begin == end == state at t = 0, accelerations consistent
  std::string facts;                 // JSON object for summary.json, see facts.hpp
  std::vector<double> sensors = {};
};

// A state on disk. The path is on the participant's host.
struct Checkpoint {
  std::uint64_t window = 0;  // number of completed windows
  Nanoseconds time;          // end of the last one
  std::string path;          // of the file, absolute
};

// ---- results

struct BodyState {
  std::uint32_t body = 0, reserved = 0;
  Pose pose;
  Twist twist;
};
struct JointState {
  std::uint32_t joint = 0;
  // Components of the reaction that rigid-body mechanics does not determine, so that one of many possible
  // values is given: bits 0, 1, 2 are force x, y, z, bits 3, 4, 5 torque x, y, z.
  std::uint32_t undetermined = 0;
  double q = 0, rate = 0;  // revolute and prismatic; else 0
  Wrench reaction;         // of the joint on the child, about the joint point, world axes
};
struct BodiesFrame {
  Nanoseconds time;
  std::vector<BodyState> bodies;
  std::vector<JointState> joints;
  double energy = 0;  // kinetic + potential of bodies and springs [J]
  // Values of scene::element_columns(); empty, and then not on the wire, without can_observe_elements and
  // where the scene has no elements.
  std::vector<double> elements = {};
  // Account of the contacts between bodies: for each boundary body the impulse since the start of the run,
  // torque about its centre of mass [N m s] and force [N s] (6), and then the energy that contacts store [J].
  // Empty, and then not on the wire, where the scene has no such contacts or the participant has no account.
  std::vector<double> contacts = {};
};

struct ParticlesFrame {  // in order of particle id, lost particles left out
  Nanoseconds time;
  std::vector<std::uint32_t> id;
  std::vector<double> position;  // [m] (n x 3)
  std::vector<float> velocity;   // [m/s] (n x 3)
  std::vector<float> spin;       // [rad/s] (n x 3)
  std::vector<float> radius;     // [m] (n)
  // Number of contacts [-] and mean stress [Pa] of each sphere (n x 2); empty, and then not on the wire,
  // without can_observe_contacts and where the scene does not ask for them.
  std::vector<float> contacts = {};
  static constexpr std::size_t contact_values = 2;
  // For each triangle of the walls of output.wall_fields, wall by wall: sums since the start of the force of
  // the spheres on it, axes of the world (3), of the normal and of the shear force [N s], the work of sliding
  // friction, and the sum of wear coefficient times normal force times sliding distance [J] (m x 7). Empty,
  // and then not on the wire, without can_observe_walls and where the scene does not ask for them.
  std::vector<double> walls = {};
  static constexpr std::size_t wall_values = 7;
  // The contacts with spheres of the bodies of output.contacts: index of the body, -1 for the ground, id of
  // the sphere, point [m], and force of the sphere on the body [N] (k x 8). Empty, and then not on the wire,
  // without can_observe_contacts and where the scene does not ask for them.
  std::vector<double> of_bodies = {};
  static constexpr std::size_t of_bodies_values = 8;
  // Pressure [Pa] and density [kg/m3] of each particle of a liquid (n x 2). Empty, and then not on the wire,
  // without can_observe_liquid.
  std::vector<float> liquid = {};
  static constexpr std::size_t liquid_values = 2;
};

struct Report {
  std::string facts;  // JSON object for summary.json, see facts.hpp
};

struct Failure {
  ErrorCode code{};
  std::string what, where, hint;
};

}  // namespace tandem::protocol
