// A particle simulation behind one interface, whatever processor, law and precision it runs on.
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
#include "dem_server/base/backend.hpp"
#include "dem_server/engine/contact_tangent.hpp"
#include "dem_server/geometry/path.hpp"
#include "dem_server/geometry/surface.hpp"
#include "dem_server/grid/skin.hpp"
#include "dem_server/state/particles.hpp"
#include "dem_server/state/window_progress.hpp"

namespace tandem::dem {

// What an engine is built from; all references outlive the constructor only.
struct EngineSetup {
  const scene::Scene& scene;
  const Surface& surface;
  const Spheres& spheres;
  SkinRange skins;       // of the neighbour lists, with what adhesion takes of it
  unsigned threads = 0;  // CPU only; 0: as ThreadPool chooses
  // Of a sphere, for which the lists have room at first: those that touch in a bed, and some more.
  double neighbours = 9;
  // Of a sphere, that a rebuild has room at first to carry over beside the lists; for three there always is,
  // but for their rolling and twisting.
  double contacts = 3;
  // Of a sphere, bodies and their facets near it.
  double walls = 1.0 / 64;
  // Indices for spheres at first, no fewer than spheres are present; 0: for those, and for some of those that
  // wait.
  std::size_t indices = 0;
  // Micro steps of the longest window, of each of which the loads are kept.
  std::uint32_t steps = 1;
};

struct WindowPlan {
  std::uint32_t steps = 0;
  double dt = 0;                        // [s]
  std::span<const PreparedPath> paths;  // one per body with walls
  double body_speed = 0;                // bound of the speed of any wall point [m/s]
  double wall_jump = 0;                 // bound of how far a wall point moved since the last window's end [m]
  Vec3d domain_shift{};                 // of the domain since the start, where it follows a body [m]
};

// Books of all spheres at one instant.
struct Totals {
  Vec3d momentum;             // [kg m/s]
  double mass = 0;            // [kg]
  double kinetic_energy = 0;  // [J]
  std::uint64_t contacts = 0;
};

struct WindowOutcome {
  WindowProgress window;
  std::vector<Wrench>
      load;  // on each body with walls about its origin, at each micro step [N] (steps x bodies)
  Totals begin, end;
  double max_overlap_ratio = 0;  // in this window [-]
  double max_speed = 0;          // bound of the spheres' speed in this window [m/s]
  double skin = 0;               // of the last list, with what adhesion takes of it [m]
  Vec3d lost_momentum;           // of spheres that left, less that of those that came in [kg m/s]
  Vec3d gravity_impulse;         // [N s]
};

// A sphere that ends a run, and all spheres as the step before left them.
class SphereError : public Error {
 public:
  SphereError(const Error& error, std::uint32_t sphere, std::uint32_t at_step, Spheres spheres)
      : Error(error), id(sphere), step(at_step), before(std::move(spheres)) {}
  std::uint32_t id;
  std::uint32_t step;  // of the window, that failed
  Spheres before;
};

// A box [min, max), or what is beyond the plane through `min` on the side of `normal`.
struct Region {
  Vec3d min, max;  // [m]
  Vec3d normal;
  bool half_space = false;
};
struct Ball {
  Vec3d x;            // centre [m]
  double radius = 0;  // [m]
};
// A sphere that comes in, one of those that wait.
struct Arrival {
  std::uint32_t id = 0;
  Ball ball;
  Vec3d v;  // [m/s]
};

// Where the arrays of a state go to, and where they come from, one after the other.
using ArraySink = std::function<void(const std::string& name, std::span<const std::byte> bytes)>;
using ArraySource = std::function<std::vector<std::byte>(const std::string& name)>;

class Engine {
 public:
  virtual ~Engine() = default;
  // Error{numerics} when a sphere is no longer finite, or a range is exceeded; SphereError where it is one
  // sphere's.
  virtual const WindowOutcome& advance(const WindowPlan& plan) = 0;
  virtual void save() = 0;
  virtual void restore() = 0;
  // All that save() keeps, as bytes. An engine of the same scene, law and precision that reads them goes on
  // to the same bits; Error{resource} where an array cannot be one of this engine.
  virtual void write(const ArraySink& sink) = 0;
  virtual void read(const ArraySource& source) = 0;
  // Of the contacts with each body's walls as the last window left them, for these poses, one per body. The
  // ground answers to nothing.
  virtual const std::vector<WallTangent>& wall_tangents(std::span<const BodyPose> poses) = 0;
  // Between two windows. What goes out and comes in is booked in the next window, as lost momentum.
  virtual std::uint64_t remove(const Region& region) = 0;  // returns how many
  virtual void insert(std::span<const Arrival> arrivals) = 0;
  // 1 for each ball that overlaps a sphere, or a wall when the bodies are in these poses, one per body.
  virtual std::vector<std::uint8_t> find_overlapping(std::span<const Ball> balls,
                                                     std::span<const BodyPose> poses) = 0;
  // Beyond which a sphere ends a run in steps of `dt` [s] [m/s].
  virtual double speed_limit(double dt) const = 0;
  // In order of id; spheres that left the domain are left out.
  virtual void download(Spheres& spheres) = 0;
  virtual std::size_t memory_bytes() const = 0;
  // Of a GPU: blocks that keep the spheres in shared memory (backend/cuda/resident/resident.cuh), once a
  // window has been done. 0: steps go through memory.
  virtual std::uint32_t regions() const = 0;
};

// How a scene is run.
struct EngineChoice {
  Backend backend = Backend::cpu;
  std::string variant;                // a name of contact_variants.def
  bool generic_fallback = false;      // no special variant for this law and precision
  std::vector<std::string> left_out;  // what the scene does not need and the variant does not do
};

EngineChoice choose_engine(const scene::Scene& scene, Backend backend);
std::unique_ptr<Engine> make_engine(const EngineChoice& choice, const EngineSetup& setup);
// Memory that such an engine takes for its arrays, with the copy that save() keeps if so asked [bytes]: with
// lists as long as a bed of spheres of one size makes them with the largest skin, and a quarter of the
// spheres near a wall. Spheres of unlike sizes may have more neighbours.
std::size_t predicted_bytes(const EngineChoice& choice, const EngineSetup& setup, bool with_copy);

}  // namespace tandem::dem
