// A liquid on a CPU or GPU: its arrays, the order of the loops of a step, and its balances.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/math/rotation.hpp"
#include "particles/base/backend.hpp"
#include "particles/geometry/path.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/geometry/region.hpp"
#include "sph_server/equations/liquid.hpp"

namespace tandem::sph {

// A body relative to which speeds are measured: a liquid that moves with it is at rest.
struct Vessel {
  std::uint32_t wall = 0;  // index in LiquidSetup::walls
  Vec3d middle;            // of its walls, in its frame [m]

  // Of the middle, where the body has this pose [m], [m/s].
  Vec3d position(const particles::BodyPose& pose) const { return pose.p + pose.R * middle; }
  Vec3d velocity(const particles::BodyPose& pose) const { return pose.v + cross(pose.w, pose.R * middle); }
};

struct LiquidSetup {
  Liquid liquid;
  scene::Box domain;           // particles that leave it are taken out [m]
  particles::Periods periods;  // of the domain
  // The domain is displaced with this one of `walls`; none: it stays.
  std::optional<std::uint32_t> follows;
  Vec3d follows_from;               // where the origin of that body is at the start [m]
  std::vector<TriangleMesh> walls;  // one per body, in its frame
  std::vector<bool> slip;           // of each body, true: without friction; empty: all have friction
  std::optional<Vessel> vessel;     // none: speeds are those in the world
  particles::Backend backend = particles::Backend::cpu;
  unsigned threads = 1;  // of the CPU; 0: see particles::ThreadPool
  // Particles that there may be where some come in later, for the range of sums; 0: those of the start.
  std::size_t capacity = 0;
};

// Particles on the host.
struct LiquidState {
  std::vector<Vec3d> position;      // [m]
  std::vector<Vec3d> velocity;      // [m/s]
  std::vector<double> compression;  // rho/rho0 - 1 [-]
  std::vector<double> pressure;     // [Pa]; read only
  std::vector<Vec3d> slope;         // gradient of the pressure [Pa/m]; read only
  std::size_t size() const { return position.size(); }
};

// Energies of the liquid and what changed them since the start [J]. The sum of kinetic and compression energy
// changes by the sum of the other ones, up to the error of the integration in time.
struct EnergyBalance {
  double kinetic = 0, compression = 0;
  double gravity = 0;         // work of gravity
  double viscosity = 0;       // of viscosity in the liquid and at walls, negative
  double bulk_viscosity = 0;  // negative
  double diffusion = 0;       // of density diffusion
  double cavitation = 0;      // of the tension that spray does not bear, and of its return to rest
  // Of the gradient of the pressure of the ghost liquid behind walls, relative to the walls. Walls at rest
  // exchange it with the liquid and keep none of it over a cycle.
  double ghost = 0;
  double repulsion = 0;  // of the repulsion by walls within a quarter of a spacing, likewise
  double walls = 0;      // of moving walls on the liquid
  // Work on bodies of the loads that they exchange at common edges; it is no energy of the liquid, and zero
  // where these bodies do not move apart.
  double edges = 0;
  double changes() const {
    return gravity + viscosity + bulk_viscosity + diffusion + cavitation + ghost + repulsion + walls;
  }
};

// Sums over all particles at one time.
struct LiquidTotals {
  Vec3d momentum;          // [kg m/s]
  double volume = 0;       // sum of m/rho [m3]
  double kinetic = 0;      // energy [J]
  double compression = 0;  // energy [J]
};

struct StepFigures {
  double largest_speed = 0;         // relative to the vessel [m/s]
  double largest_acceleration = 0;  // [m/s2]
  double largest_compression = 0;   // largest |rho/rho0 - 1|: some 0.01 where the sound speed suffices [-]
  // Of the particles beyond largest_flow_mach and beyond largest_density_error: their share of all, and the
  // root of the mean square of their Mach numbers and compressions [-].
  double fast_share = 0, fast_mach = 0, dense_share = 0, dense_compression = 0;
  Vec3d pair_impulse_rate;         // sum of all pair forces [N]: zero
  std::uint64_t rebuilds = 0;      // of the lists since the start
  std::uint64_t passed_walls = 0;  // particles that passed a wall since the start
};

// What a step costs, as set_state() found it.
struct StartCost {
  std::uint32_t beside_walls = 0;  // particles with facets in their lists
  double rates_seconds = 0;        // wall time of the rates of all particles [s]
};

// A particle that has left.
struct TakenParticle {
  std::uint32_t number = 0;  // among those before
  Vec3d position, velocity;  // [m], [m/s]
  double compression = 0;    // [-]
};

// Particles that left the domain and were taken out.
struct LostParticles {
  std::vector<std::uint32_t> index;  // ascending, as they were numbered before
  Vec3d momentum;                    // [kg m/s]
  double energy = 0;                 // kinetic and of compression [J]
};

// Steps under the same pressure for all particles, without gravity.
struct Packing {
  double pressure = 0;  // in units of rho0 c0^2 [-]
  double damping = 1;   // factor of the velocities in each step [-]
  int steps = 0;        // each as long as step_limits() allows at the speed of sound
};

class LiquidEngine {
 public:
  virtual ~LiquidEngine() = default;
  // Bodies have the given poses, one per wall mesh. Rates are computed at once, so that loads() belongs to
  // this state. Error{numerics} where a particle is outside the domain.
  virtual void set_state(const LiquidState& state, const std::vector<particles::BodyPose>& poses) = 0;
  void set_state(const LiquidState& state) { set_state(state, poses()); }
  virtual LiquidState state() const = 0;
  // One step of dt [s]. Error{numerics} where it is longer than step_limits() of the present speeds and
  // accelerations allow. Bodies then have the given poses, one per wall mesh.
  // next: length of the step that follows, if nothing else happens to the liquid before it, not even save();
  // otherwise 0. Every second step of such a row uses the integrals over walls of the step before, which are
  // then those in the middle between the two [s].
  virtual void step(double dt, const std::vector<particles::BodyPose>& poses, double next = 0) = 0;
  // One of many steps in which bodies stay where they are.
  void step(double dt) { step(dt, poses(), dt); }
  virtual const std::vector<particles::BodyPose>& poses() const = 0;
  // Those of the last step() or exchange(), once. Particles outside the domain are found when the lists are
  // built; the others keep their order. The next step has no step before it, as the first one.
  virtual LostParticles take_lost() = 0;
  // Takes particles out, by ascending index, and appends those of `arriving`; bodies then have the given
  // poses. Rates are computed at once. The next step has no step before it, as the first one.
  virtual void exchange(std::span<const std::uint32_t> leaving, const LiquidState& arriving,
                        const std::vector<particles::BodyPose>& poses) = 0;
  // Takes the particles in any of these regions out, by ascending number; the others keep their order. Where
  // there are some, rates are computed at once, and the next step has no step before it.
  virtual std::vector<TakenParticle> take_out(const std::vector<particles::OutletRegion>& regions) = 0;
  // Moves particles apart until walls and particles fill the space evenly. after_step(k) is called after step
  // k. Error{numerics} where a particle leaves the domain.
  virtual void pack(const Packing& how, const std::function<void(int)>& after_step) = 0;
  // Force of the liquid on each body and its torque about the origin of the body, at the current state. Where
  // walls of two bodies meet, the loads include what each exerts on the other through the ghost liquid behind
  // them; their sum is the exact opposite of the force on the liquid.
  virtual std::vector<Wrench> loads() const = 0;
  // The same as the mean over the last step, about the origins at its begin: times dt it is the opposite of
  // the impulse that the liquid got from the bodies.
  virtual const std::vector<Wrench>& step_loads() const = 0;
  // Error{numerics} where a speed is not finite or a density is off by its own size.
  virtual LiquidTotals totals() const = 0;
  Vec3d momentum() const { return totals().momentum; }  // of the liquid [kg m/s]
  double volume() const { return totals().volume; }     // sum of m/rho of the particles [m3]
  virtual particles::RegionSums sums_in(const particles::MeasuredRegion& region) const = 0;
  // The particles less than `radius` [m] from the line through `from` along a unit vector, in their order;
  // where `along` is zero, from the point.
  virtual LiquidState near_line(Vec3d from, Vec3d along, double radius) const = 0;
  virtual EnergyBalance energies() const = 0;
  virtual StepFigures figures() const = 0;
  virtual StartCost start_cost() const = 0;

  // One copy of the whole state in memory. restore() may be called more than once per save().
  virtual void save() = 0;
  virtual void restore() = 0;
  // The same as named arrays. An engine of the same setup, whose state has been set, continues with the same
  // bits once it has read them.
  // read: Error{resource} where an array has another size than that of so many particles.
  using Sink = std::function<void(const std::string& name, std::span<const std::byte> bytes)>;
  using Source = std::function<std::vector<std::byte>(const std::string& name)>;
  virtual void write(const Sink& sink) const = 0;
  virtual void read(const Source& source, std::size_t particles) = 0;
};

// Error{scene} for a liquid whose properties are out of range. `single`: pair arithmetic and what neighbours
// read in single precision; position, velocity and compression of a particle keep more digits.
// Error{resource} for a back end that this build or machine has not.
std::unique_ptr<LiquidEngine> make_liquid_engine(const LiquidSetup& setup, bool single);

// Memory of the particles of such an engine with their lists and copies of both, as save() makes them,
// without walls and cells [bytes]. The lists are those of particles in a lattice.
std::size_t predicted_bytes(std::size_t particles, const LiquidSetup& setup, bool single, bool with_copy);

}  // namespace tandem::sph
