// Grains of a scene.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/scene/keys.hpp"
#include "common/scene/model_shapes.hpp"

namespace tandem::scene {

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

// The spheres come to rest before the start, with all walls at rest.
struct Settle : SettleKeys {};

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

}  // namespace tandem::scene
