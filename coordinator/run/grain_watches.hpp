// All that is watched of the grains of a run (particle_watch.hpp, sphere_watch.hpp, wall_load_watch.hpp).
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "coordinator/run/summary.hpp"
#include "coordinator/watch/particle_watch.hpp"
#include "coordinator/watch/sphere_watch.hpp"
#include "coordinator/watch/wall_load_watch.hpp"

namespace tandem::launch {

class GrainWatches {
 public:
  // `scene` stays alive as long as the watches. Our own solver is watched by its account alone: how single
  // spheres move, and which walls they press on, is tested with it (`tandem conform`), and costs a search for
  // neighbours in each frame.
  GrainWatches(const scene::Scene& scene, std::unique_ptr<ParticleWatch> particles, bool foreign)
      : particles_(std::move(particles)) {
    if (!foreign) return;
    walls_.emplace(scene);
    spheres_.emplace(scene, particles_->spheres());
  }

  const SceneSpheres& spheres() const { return particles_->spheres(); }

  // The run continues from a checkpoint, before which so many spheres were lost.
  void continue_after(std::uint64_t lost) { particles_->continue_after(lost); }

  // A window that was accepted: what the grains did in it. Throws Error{protocol} where that is impossible.
  void record(const Exchange& window);
  // A frame that was received at once. Throws Error{protocol} where it is the first one and has other spheres
  // than the scene.
  void begin(const protocol::ParticlesFrame& frame);
  // What the windows so far say of the frame after them, to be called with that frame once, in the order of
  // the frames and in any thread. `window`: the last one; null before the first.
  using FrameCheck = std::function<void(const protocol::ParticlesFrame&)>;
  FrameCheck check_of_frame(const Exchange* window);

  void add_to(Summary& summary) const;

 private:
  std::unique_ptr<ParticleWatch> particles_;
  std::optional<WallLoadWatch> walls_;
  std::optional<SphereWatch> spheres_;  // reads the spheres of `particles_`
};

}  // namespace tandem::launch
