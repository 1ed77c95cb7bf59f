#include "coordinator/run/grain_watches.hpp"

namespace tandem::launch {

void GrainWatches::record(const Exchange& window) {
  particles_->record(window);
  if (walls_) walls_->record(window);
  if (spheres_) spheres_->record(window);
}

void GrainWatches::begin(const protocol::ParticlesFrame& frame) {
  particles_->expect_start(frame);
  if (spheres_) spheres_->begin(frame);
}

GrainWatches::FrameCheck GrainWatches::check_of_frame(const Exchange* window) {
  return [this, of_particles = particles_->take_before(),
          of_spheres = spheres_ ? spheres_->take_before() : SphereWatch::Before(),
          last = walls_ && window ? std::optional(*window)
                                  : std::nullopt](const protocol::ParticlesFrame& frame) {
    particles_->check(frame, of_particles);
    if (spheres_) spheres_->check(frame, of_spheres);
    if (last) walls_->observe(frame, *last);
  };
}

void GrainWatches::add_to(Summary& summary) const {
  summary.set_particles(*particles_, spheres_ ? &*spheres_ : nullptr);
  if (walls_) summary.set_wall_loads(*walls_);
}

}  // namespace tandem::launch
