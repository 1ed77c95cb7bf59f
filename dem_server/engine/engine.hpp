// The interface of a particle simulation, independent of the processor, the law and the precision.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/scene/model.hpp"
#include "dem_server/engine/contact_tangent.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/backend.hpp"
#include "particles/base/ranks.hpp"
#include "particles/geometry/path.hpp"
#include "particles/geometry/region.hpp"
#include "particles/geometry/surface.hpp"
#include "particles/grid/skin.hpp"
#include "particles/state/particles.hpp"
#include "particles/state/window_progress.hpp"

namespace tandem::dem {

// What an engine is built from. The references need to be valid during the constructor only.
struct EngineSetup {
  const scene::Scene& scene;
  const Surface& surface;
  const Spheres& spheres;
  SkinRange skins;       // of the neighbour lists, including the range of adhesion
  unsigned threads = 0;  // CPU only; 0: ThreadPool chooses
  // Initial room of the lists: neighbours per sphere. A sphere of a bed is in contact with fewer.
  double neighbours = 9;
  // Initial room for contacts that a rebuild carries over, per sphere. Three always fit besides, though not
  // their rolling and twisting.
  double contacts = 3;
  // Initial room of the lists: bodies, and facets, near a sphere, per sphere.
  double walls = 1.0 / 64;
  // Initial number of indices for spheres, at least that of the spheres that are present. 0: for those, and
  // for some of the spheres that wait.
  std::size_t indices = 0;
  // Micro steps of the longest window; the loads of each step are stored.
  std::uint32_t steps = 1;
  Ranks* ranks = nullptr;  // the others that compute these spheres; null: none
};

struct WindowPlan {
  std::uint32_t steps = 0;
  double dt = 0;                        // [s]
  std::span<const PreparedPath> paths;  // one per body with walls
  double body_speed = 0;                // bound of the speed of any wall point [m/s]
  double wall_jump = 0;                 // bound of how far a wall point moved since the last window's end [m]
  Vec3d domain_shift{};                 // of the domain since the start, where it follows a body [m]
  // Where there are belts, their velocities in the body's frame in each micro step, and at the end of the
  // window ((steps + 1) x bodies) [m/s]. Zero for the other walls.
  std::span<const Vec3d> belt_velocity{};
};

// Totals of all spheres at one instant.
struct Totals {
  Vec3d momentum;             // [kg m/s]
  double mass = 0;            // [kg]
  double kinetic_energy = 0;  // [J]
  std::uint64_t contacts = 0;
};

struct WindowOutcome {
  WindowProgress window;
  // On each body with walls, about its origin, in each micro step (steps x bodies).
  std::vector<Wrench> load;
  // Where there are belts: the tangential force of the spheres on each belt along its velocity, in each micro
  // step (steps x bodies) [N].
  std::vector<double> belt_pull;
  Totals begin, end;
  // Where walls have sensors: on each of those walls, sums over the window divided by its length
  // (rows x wall_sum_count) [N] [W].
  std::vector<double> wall_means;
  double max_overlap_ratio = 0;  // in this window [-]
  double max_speed = 0;          // bound of the spheres' speed in this window [m/s]
  double skin = 0;               // of the last list, including the range of adhesion [m]
  Vec3d lost_momentum;           // of spheres that left, minus that of spheres that came in [kg m/s]
  Vec3d gravity_impulse;         // [N s]
};

// The error of one sphere that ends a run, with all spheres before the step that failed.
class SphereError : public Error {
 public:
  SphereError(const Error& error, std::uint32_t sphere, std::uint32_t at_step, Spheres spheres)
      : Error(error), id(sphere), step(at_step), before(std::move(spheres)) {}
  std::uint32_t id;
  std::uint32_t step;  // number of the failed step in its window
  Spheres before;
};

struct Ball {
  Vec3d x;            // centre [m]
  double radius = 0;  // [m]
};
// A waiting sphere that comes in.
struct Arrival {
  std::uint32_t id = 0;
  Ball ball;
  Vec3d v;  // [m/s]
};

// Receives, or supplies, the arrays of a state one after the other.
using ArraySink = std::function<void(const std::string& name, std::span<const std::byte> bytes)>;
using ArraySource = std::function<std::vector<std::byte>(const std::string& name)>;

// The spheres of a frame, in order of id, with three numbers of each vector in turn.
struct SphereFrame {
  std::vector<std::uint32_t> id;
  std::vector<double> position;  // [m]
  std::vector<float> velocity;   // [m/s]
  std::vector<float> spin;       // [rad/s]
  std::vector<float> radius;     // [m]
};

// What the contacts of the spheres are evaluated with for a frame (engine/contact_fields.hpp).
struct ContactsRequest {
  std::span<const BodyPose> poses;  // of the bodies now, one per body
  double dt = 0;                    // micro step [s]
};
// Contacts of the spheres, in order of id.
struct ContactsFrame {
  std::vector<std::uint32_t> count;  // with spheres and walls
  std::vector<double> mean_stress;   // see SphereContacts [Pa]
};

// A contact of a sphere with the walls of a body.
struct BodyContact {
  std::uint32_t body = 0, sphere = 0;  // boundary body index, id
  Vec3d point;                         // of the wall [m]
  Vec3d force;                         // of the sphere on the body [N]
};

// With ranks, all calls are collective. They return the same on all ranks, but spheres only on rank 0.
class Engine {
 public:
  virtual ~Engine() = default;
  // Error{numerics} where a value is not finite or exceeds its range; SphereError where one sphere causes it.
  virtual const WindowOutcome& advance(const WindowPlan& plan) = 0;
  virtual void save() = 0;
  virtual void restore() = 0;
  // The state that save() keeps, as bytes; with ranks that of all of them, on rank 0 only. An engine of the
  // same scene, law and precision that reads them continues with the same bits, on any number of ranks.
  // Error{resource} where an array does not fit this engine.
  virtual void write(const ArraySink& sink) = 0;
  virtual void read(const ArraySource& source) = 0;
  // Tangents of the contacts with each body's walls at the end of the last window, for these poses, one per
  // body. Those of the ground are zero.
  virtual const std::vector<WallTangent>& wall_tangents(std::span<const BodyPose> poses) = 0;
  // To be called between two windows. The next window records the momentum of these spheres in lost_momentum.
  // remove() returns the number of spheres that it removes.
  virtual std::uint64_t remove(const OutletRegion& region) = 0;
  virtual void insert(std::span<const Arrival> arrivals) = 0;
  // 1 for each ball that overlaps a sphere, or a wall when the bodies are in these poses, one per body.
  virtual std::vector<std::uint8_t> find_overlapping(std::span<const Ball> balls,
                                                     std::span<const BodyPose> poses) = 0;
  // To be called between two windows; the state does not change.
  virtual const std::vector<RegionSums>& measure(std::span<const MeasuredRegion> regions) = 0;
  // Sums since the start on each triangle of the walls with fields (rows x wall_sum_count) [N s] [J], in the
  // order of engine/wall_rows.hpp.
  virtual const std::vector<double>& wall_fields() = 0;
  // Energy that contacts have dissipated since the start, by enum Dissipation [J]; empty where the scene does
  // not ask for it.
  virtual std::vector<double> dissipated() = 0;
  // The speed beyond which a sphere ends a run with micro steps of `dt` [s] [m/s].
  virtual double speed_limit(double dt) const = 0;
  // The present spheres in order of id, without those that left the domain.
  virtual void download(Spheres& spheres) = 0;
  // The same in the form of a frame, in which they are sent.
  virtual void download(SphereFrame& frame) = 0;
  // Keeps those that download() would return now. read_snapshot() returns them and may be called by another
  // thread during advance().
  virtual void snapshot() = 0;
  virtual void read_snapshot(SphereFrame& frame) = 0;
  // The contacts of the same spheres, with the forces of the micro step that comes next. The state stays as
  // it is.
  virtual void download(const ContactsRequest& request, ContactsFrame& frame) = 0;
  // The contacts of the bodies for which `wanted` is not 0, one value per body, in order of body and sphere,
  // with the forces of the micro step that comes next.
  virtual std::vector<BodyContact> body_contacts(const ContactsRequest& request,
                                                 std::span<const std::uint8_t> wanted) = 0;
  virtual std::size_t memory_bytes() const = 0;
  // The number of blocks of a GPU that keep the spheres in shared memory
  // (backend/cuda/resident/resident.cuh). 0: no window has been done yet, or steps go through global memory.
  virtual std::uint32_t regions() const = 0;
  // With ranks: work of the busiest rank over the mean of all, by the pairs in the present lists [-].
  virtual double rank_imbalance() const = 0;
};

// The variant and the back end that run a scene.
struct EngineChoice {
  Backend backend = Backend::cpu;
  std::string variant;                // a name of contact_variants.def
  bool generic_fallback = false;      // no special variant for this law and precision
  std::vector<std::string> left_out;  // for the log: work that the scene does not need
};

EngineChoice choose_engine(const scene::Scene& scene, Backend backend);
std::unique_ptr<Engine> make_engine(const EngineChoice& choice, const EngineSetup& setup);
// Memory of the arrays of such an engine [bytes]; `with_copy` includes the copy that save() makes. The
// estimate assumes a bed of spheres of one size, the largest skin, and a quarter of the spheres near a wall.
// Spheres of different sizes may have more neighbours.
std::size_t predicted_bytes(const EngineChoice& choice, const EngineSetup& setup, bool with_copy);

}  // namespace tandem::dem
