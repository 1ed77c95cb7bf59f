// A particle simulation behind one interface, whatever processor, law and precision it runs on.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "dem_server/core/backend.hpp"
#include "dem_server/core/control.hpp"
#include "dem_server/geometry/path.hpp"
#include "dem_server/geometry/surface.hpp"
#include "dem_server/model/particles.hpp"
#include "dem_server/step/contact_tangent.hpp"

namespace tandem::dem {

// What an engine is built from; all references outlive the constructor only.
struct EngineSetup {
  const scene::Scene& scene;
  const Surface& surface;
  const Spheres& spheres;
  double skin = 0;       // Verlet skin [m]
  unsigned threads = 0;  // CPU only; 0: all cores
};

struct WindowPlan {
  std::uint32_t steps = 0;
  double dt = 0;                        // [s]
  std::span<const PreparedPath> paths;  // one per body slot
  double body_speed = 0;                // bound of the speed of any wall point [m/s]
  double wall_jump = 0;                 // bound of how far a wall point moved since the last window's end [m]
};

// Books of all spheres at one instant.
struct Books {
  Vec3d momentum;             // [kg m/s]
  double mass = 0;            // [kg]
  double kinetic_energy = 0;  // [J]
  std::uint64_t contacts = 0;
};

struct WindowOutcome {
  Control control;
  std::vector<Wrench> load;  // on each slot's body about its origin, at each micro step [N] (steps x slots)
  Books begin, end;
  Vec3d lost_momentum;    // of spheres that left the domain [kg m/s]
  Vec3d gravity_impulse;  // [N s]
};

class Engine {
 public:
  virtual ~Engine() = default;
  // Error{numerics} when a sphere is no longer finite, or a range is exceeded; the error names the sphere.
  virtual const WindowOutcome& advance(const WindowPlan& plan) = 0;
  virtual void save() = 0;
  virtual void restore() = 0;
  // Of all contacts with walls as the last window left them, for these poses of the bodies, one per slot.
  virtual const std::vector<ContactTangent>& wall_tangents(std::span<const BodyPose> poses) = 0;
  // In order of id; spheres that left the domain are left out.
  virtual void download(Spheres& spheres) = 0;
  virtual std::size_t memory_bytes() const = 0;
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

}  // namespace tandem::dem
