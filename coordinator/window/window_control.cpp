#include "coordinator/window/window_control.hpp"

#include <algorithm>
#include <cmath>

namespace tandem::launch {
namespace {

// The errors of a window fall at least with H^2.
constexpr double order = 2;
constexpr double safety = 0.9, integral = 0.7 / order, proportional = 0.4 / order;
constexpr double most_growth = 2, most_shrinking = 0.2, most_after_rejection = 0.5;

}  // namespace

WindowControl::WindowControl(const scene::Coupling& coupling)
    : adaptive_(coupling.adaptive), length_(to_nanoseconds(coupling.window)) {}

Nanoseconds WindowControl::end(Nanoseconds now, Nanoseconds limit) const {
  const Nanoseconds left = limit - now;
  if (left <= length_) return limit;
  // Two equal windows instead of a long one and a very short one.
  if (adaptive_ && left.count < 2 * length_.count) return {now.count + (left.count + 1) / 2};
  return now + length_;
}

bool WindowControl::accept(const Window& window, const WindowError& error, double micro_step, double stable) {
  if (!adaptive_) return true;
  const double H = window.length();
  // If hardly anything is exchanged in a window, its error is compared with the average exchange per
  // window.
  const double level = std::max(error.exchanged, time_ > 0 ? exchanged_ / time_ * H : 0);
  const double of_energy = level > 0 ? error.energy / (adaptive_->energy_tolerance * level) : 0;
  const double relative = std::max({of_energy, error.path / adaptive_->path_tolerance, 1e-6});
  if (relative > 1 &&
      reject(window,
             std::clamp(safety * std::pow(relative, -1 / order), most_shrinking, most_after_rejection),
             micro_step))
    return false;
  if (relative > 1) ++too_wrong_;
  double factor = safety * std::pow(relative, -integral) * std::pow(last_error_, proportional);
  // Directly after a rejection a longer window would be rejected again.
  factor = std::clamp(factor, most_shrinking, after_rejection_ ? 1.0 : most_growth);
  after_rejection_ = false;
  last_error_ = relative;
  exchanged_ += error.exchanged;
  time_ += H;
  // A window that was cut to end at a frame does not speak against a longer one.
  const double length = factor < 1 ? factor * H : std::max(factor * H, to_seconds(length_));
  set_length(std::min(length, safety * stable), micro_step);
  return true;
}

bool WindowControl::shorten(const Window& window, double micro_step) {
  return adaptive_ && reject(window, most_after_rejection, micro_step);
}

// A window of one micro step is not repeated either: it could not be shorter.
bool WindowControl::reject(const Window& window, double factor, double micro_step) {
  const Nanoseconds length = length_;
  set_length(factor * window.length(), micro_step);
  if (length_ < window.end - window.begin) {
    after_rejection_ = true;
    return true;
  }
  length_ = length;
  return false;
}

void WindowControl::save_or_restore(Archive& archive) {
  const Nanoseconds of_scene = length_;  // when it reads, before the first window
  archive("window_control/length", length_);
  archive("window_control/last_error", last_error_);
  archive("window_control/exchanged", exchanged_);
  archive("window_control/time", time_);
  archive("window_control/after_rejection", after_rejection_);
  archive("window_control/too_wrong", too_wrong_);
  archive.expect(!adaptive_ || (length_ >= to_nanoseconds(adaptive_->min_window) &&
                                length_ <= to_nanoseconds(adaptive_->max_window)),
                 "window_control/length", "the window is not within coupling.adaptive");
  archive.expect(adaptive_ || length_ == of_scene, "window_control/length",
                 "the window is not coupling.window of the scene");
  const auto expect_positive = [&](const char* name, double value) {
    archive.expect(std::isfinite(value) && value >= 0, name, "it is not a finite number of at least 0");
  };
  expect_positive("window_control/last_error", last_error_);
  expect_positive("window_control/exchanged", exchanged_);
  expect_positive("window_control/time", time_);
}

void WindowControl::set_length(double length, double micro_step) {
  length = std::clamp(length, adaptive_->min_window, adaptive_->max_window);
  // Rounded down: a nanosecond more would cost another micro step. Half a nanosecond allows for the
  // rounding of the product.
  if (micro_step > 0) {
    const double steps = std::max(1.0, std::floor(length / micro_step * (1 + 1e-9)));
    length_ = {static_cast<std::int64_t>(std::floor(steps * micro_step * 1e9 + 1e-3))};
  } else {
    length_ = to_nanoseconds(length);
  }
  length_ = std::clamp(length_, to_nanoseconds(adaptive_->min_window), to_nanoseconds(adaptive_->max_window));
}

}  // namespace tandem::launch
