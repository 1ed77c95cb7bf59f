#include "coordinator/window/coupler.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/log.hpp"
#include "coordinator/schemes/implicit.hpp"

namespace tandem::launch {

Coupler::Coupler(const scene::Scene& scene, const Solvers& solvers)
    : scene_(scene),
      solvers_(solvers),
      scheme_(make_scheme(scene, solvers)),
      control_(scene.coupling),
      space_(scene, Departure::straight),
      watch_(scene),
      liquid_watch_(scene),
      watching_(solvers.mbd && any_linearises(solvers)),
      supported_(watching_ && scene.contact && solvers.mbd->can(protocol::can_linearise)),
      body_momentum_(scene),
      motion_watch_(scene),
      path_watch_(scene),
      joint_watch_(scene),
      energy_watch_(scene) {}

void Coupler::observe(const protocol::BodiesFrame& frame) {
  motion_watch_.observe(frame.time, frame.bodies);
  joint_watch_.observe(frame);
  energy_watch_.observe(frame);
  body_momentum_.observe(frame);
}

Window Coupler::next(Nanoseconds limit) const {
  return {windows_, now_, control_.end(now_, limit)};
}

const Exchange& Coupler::advance(Nanoseconds limit) {
  while (!try_window(next(limit))) {
    ++counters_.rejected;
    solvers_.mbd->restore();
    restore_loads(solvers_);
    exchange_ = before_;
  }
  return exchange_;
}

// Whether the window is accepted. If not, both sides are still in their state at its end.
bool Coupler::try_window(const Window& window) {
  if (control_.adaptive()) {
    solvers_.mbd->save();
    save_loads(solvers_);
    before_ = exchange_;
  }
  exchange_.held = false;
  exchange_.iterations = 1;
  if (watching_ && windows_ == 0) exchange_.tangents.responses = responses_of(solvers_);
  try {
    scheme_->advance(window, exchange_);
  } catch (const NotConverged&) {
    counters_.iterations += static_cast<std::uint64_t>(exchange_.iterations);
    if (!control_.shorten(window, exchange_.load.account.micro_step)) throw;
    return false;
  }
  counters_.iterations += static_cast<std::uint64_t>(exchange_.iterations);
  look_at_contacts();

  const WindowBalance balance = accounts_.balance_of(exchange_);
  const WindowError error{std::abs(balance.created()), balance.exchanged(), distance()};
  if (!control_.accept(window, error, exchange_.load.account.micro_step,
                       std::min(watch_.stable_window(), liquid_watch_.stable_window())))
    return false;
  accounts_.record(exchange_);
  body_momentum_.record(exchange_);
  motion_watch_.record(exchange_.motion);
  path_watch_.record(exchange_);
  counters_.most_iterations = std::max(counters_.most_iterations, exchange_.iterations);
  now_ = window.end;
  window_ = window;
  ++windows_;
  return true;
}

void Coupler::save_or_restore(Archive& archive) {
  archive("time", now_);
  archive("windows", windows_);
  archive("last_window", window_);
  archive("counters", counters_);
  archive("warnings", warnings_);
  archive("exchange/path", exchange_.path);
  archive("exchange/load", exchange_.load);
  if (solvers_.loads.size() > 1) {
    exchange_.parts.resize(solvers_.loads.size());
    for (std::size_t i = 0; i < exchange_.parts.size(); ++i)
      archive("exchange/parts/" + std::to_string(i), exchange_.parts[i]);
  }
  archive("exchange/applied", exchange_.applied);
  archive("exchange/motion", exchange_.motion);
  archive("exchange/tangents", exchange_.tangents);
  archive("exchange/held", exchange_.held);
  archive("exchange/iterations", exchange_.iterations);
  control_.save_or_restore(archive);
  archive.expect(control_.too_wrong() <= windows_, "window_control/too_wrong", "there were fewer windows");
  archive.expect(exchange_.iterations >= 0, "exchange/iterations", "it is negative");
  const bool before_the_first = windows_ == 0 && window_.begin == window_.end;
  archive.expect(
      now_ >= Nanoseconds{} && now_ == window_.end && (before_the_first || window_.begin < window_.end),
      "last_window", "it does not end at `time`");
  accounts_.save_or_restore(archive, scene_.mbd ? scene_.mbd->bodies.size() : 0, solvers_.loads.size());
  archive.expect(accounts_.windows() == windows_, "accounts/windows", "it is another number than `windows`");
  body_momentum_.save_or_restore(archive, scene_.mbd ? scene_.mbd->bodies.size() : 0);
  motion_watch_.save_or_restore(archive, scene_.mbd ? scene_.mbd->bodies.size() : 0);
  path_watch_.save_or_restore(archive, scene_.mbd ? scene_.mbd->bodies.size() : 0);
  joint_watch_.save_or_restore(archive);
  energy_watch_.save_or_restore(archive);
  watch_.save_or_restore(archive, windows_ + counters_.rejected);
  liquid_watch_.save_or_restore(archive);
  scheme_->save_or_restore(archive);
}

void Coupler::look_at_contacts() {
  if (!watching_) return;
  if (exchange_.tangents.time != exchange_.load.window.end) exchange_.tangents = linearise_loads(solvers_);
  const protocol::TangentSet& supports = supported_ ? solvers_.mbd->linearise() : no_supports_;
  if (const auto sentence = watch_.observe(exchange_.tangents, supports, exchange_.motion)) {
    // Adaptive windows stay below the limit because they follow the error.
    if (!control_.adaptive()) warn(*sentence);
  }
  const double step = exchange_.load.account.micro_step;
  if (const auto sentence = liquid_watch_.observe(exchange_.tangents.responses, exchange_.motion, step);
      sentence && !(control_.adaptive() && control_.may_follow(liquid_watch_.stable_window())))
    warn(*sentence);
}

void Coupler::warn(const std::string& sentence) {
  log::warn("{}", sentence);
  warnings_.push_back(sentence);
}

// Distance between the end of the path prescribed to the particles and the end of the path that the bodies
// took; a rotation counts as the displacement of a point at the radius of gyration [m].
double Coupler::distance() const {
  double largest = 0;
  for (std::size_t b = 0; b < exchange_.path.bodies.size() && b < exchange_.motion.bodies.size(); ++b) {
    const protocol::BodyMotion &prescribed = exchange_.path.bodies[b], &taken = exchange_.motion.bodies[b];
    const double turn = norm(rotation_vector(taken.end_pose.q_WB * prescribed.end_pose.q_WB.conjugate()));
    largest = std::max(largest, norm(taken.end_pose.p_WB - prescribed.end_pose.p_WB) +
                                    space_.gyration(prescribed.body) * turn);
  }
  return largest;
}

}  // namespace tandem::launch
