#include "coordinator/run/run_frames.hpp"

#include <algorithm>
#include <utility>

namespace tandem::launch {

using protocol::Role;

void RunFrames::write(const BetweenWindows& now) {
  stopwatch_.begin_output(solvers_);
  folder_.expect_there();
  if (have(Role::sph)) solvers_.of(Role::sph)->observe_particles(now.time, results_.liquid_to_write());
  protocol::ParticlesFrame* frame = have(Role::dem) ? &results_.particles_to_write() : nullptr;
  GrainWatches::FrameCheck check;
  if (frame) {
    solvers_.of(Role::dem)->observe_particles(now.time, *frame);
    watches_->begin(*frame);
    check = watches_->check_of_frame(now.window);
  }
  results_.write_frame(now.time, now.bodies, frame, check);
  set_next(now.time);
  stopwatch_.end_output(solvers_);
}

void RunFrames::begin(const BetweenWindows& now) {
  if (!can_begin()) return write(now);
  stopwatch_.begin_output(solvers_);
  for (protocol::Remote* solver : solvers_.loads) solver->snapshot(now.time);
  begun_ = {now.time, now.bodies ? std::optional(*now.bodies) : std::nullopt,
            watches_ ? watches_->check_of_frame(now.window) : GrainWatches::FrameCheck(), 0};
  set_next(now.time);
  stopwatch_.end_output(solvers_);
}

void RunFrames::after_window(Nanoseconds now) {
  if (begun_ && (++begun_->windows == windows_of_a_frame || now >= next_)) fetch();
}

void RunFrames::fetch() {
  if (!begun_) return;
  stopwatch_.begin_output(solvers_);
  folder_.expect_there();
  const Begun begun = *std::exchange(begun_, {});
  if (scene_.sph) solvers_.of(Role::sph)->observe_particles(begun.time, results_.liquid_to_write());
  protocol::ParticlesFrame* frame = nullptr;
  Results::PrepareParticles prepare;
  if (scene_.dem) {
    frame = &results_.particles_to_write();  // waits until received_ is free
    solvers_.of(Role::dem)->receive_particles(begun.time, received_);
    prepare = [this, check = begun.check](protocol::ParticlesFrame& spheres) {
      received_.read(spheres);
      check(spheres);
    };
  }
  results_.write_frame(begun.time, begun.bodies ? &*begun.bodies : nullptr, frame, prepare);
  stopwatch_.end_output(solvers_);
}

// Whether frames have the particles of this solver.
bool RunFrames::have(Role role) const {
  return scene_.output.particles && solvers_.of(role) != nullptr;
}

bool RunFrames::can_begin() const {
  return scene_.output.particles && !solvers_.loads.empty() &&
         std::ranges::all_of(solvers_.loads, [](const protocol::Remote* solver) {
           return solver->can(protocol::can_snapshot);
         });
}

void RunFrames::set_next(Nanoseconds now) {
  last_ = now;
  const Nanoseconds interval = to_nanoseconds(scene_.output.frame_interval);
  while (next_ <= now)
    next_ = interval.count > 0 ? next_ + interval : to_nanoseconds(scene_.end_time) + Nanoseconds{1};
}

}  // namespace tandem::launch
