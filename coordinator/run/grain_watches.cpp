#include "coordinator/run/grain_watches.hpp"

namespace tandem::launch {

void GrainWatches::record(const Exchange& window) {
  particles_->record(window);
  walls_.record(window);
  spheres_.record(window);
}

void GrainWatches::begin(const protocol::ParticlesFrame& frame) {
  particles_->expect_start(frame);
  spheres_.begin(frame);
}

GrainWatches::FrameCheck GrainWatches::check_of_frame(const Exchange* window) {
  FrameCheck check = [this, of_particles = particles_->take_before(),
                      of_spheres = spheres_.take_before()](const protocol::ParticlesFrame& frame) {
    particles_->check(frame, of_particles);
    spheres_.check(frame, of_spheres);
  };
  if (!window) return check;
  return [this, check, last = *window](const protocol::ParticlesFrame& frame) {
    check(frame);
    walls_.observe(frame, last);
  };
}

void GrainWatches::add_to(Summary& summary) const {
  summary.set_particles(*particles_, spheres_);
  summary.set_wall_loads(walls_);
}

}  // namespace tandem::launch
