// Determines the length of the next window. Without `adaptive` every window has the length of the scene. With
// it the window follows the error of the last one by a proportional-integral rule, as for ordinary step sizes
// (Soederlind, Numer. Algorithms 31, 2002; for energy residuals of a coupling: Sadjina et al., Eng. Comput.
// 33, 2017). A window with too large an error is restored on both sides and repeated with a shorter length.
#pragma once

#include <optional>

#include "common/scene/model.hpp"
#include "common/time.hpp"
#include "coordinator/schemes/archive.hpp"

namespace tandem::launch {

// Errors of a window, in absolute terms.
struct WindowError {
  double energy = 0;     // |energy created| [J]
  double exchanged = 0;  // energy exchanged [J]
  double path = 0;       // largest distance between the prescribed path and the path taken [m]
};

class WindowControl {
 public:
  explicit WindowControl(const scene::Coupling& coupling);

  bool adaptive() const { return adaptive_.has_value(); }
  // Whether adaptive windows may be as short as `stable` [s].
  bool may_follow(double stable) const { return adaptive_ && stable >= adaptive_->min_window; }
  // The end of the window that begins now, no later than `limit`.
  Nanoseconds end(Nanoseconds now, Nanoseconds limit) const;
  // Whether a window with this error is accepted; sets the length of the next window, or of the repetition.
  // `micro_step` is the particles' step [s]: windows are a whole number of them. `stable` is the longest
  // window that suits the contacts [s].
  bool accept(const Window& window, const WindowError& error, double micro_step, double stable);
  // Call when the window could not be computed: takes a shorter one. Returns false where none is possible.
  bool shorten(const Window& window, double micro_step);
  // Windows that were accepted although their error is too large, because a shorter one is not allowed, or
  // would not hold a micro step.
  std::uint64_t too_wrong() const { return too_wrong_; }
  void save_or_restore(Archive& archive);

 private:
  void set_length(double length, double micro_step);
  // Whether the window is repeated, shorter by that factor.
  bool reject(const Window& window, double factor, double micro_step);

  std::optional<scene::Adaptive> adaptive_;
  Nanoseconds length_;
  double last_error_ = 1;            // relative to the tolerance [-]
  double exchanged_ = 0, time_ = 0;  // over the run [J] [s]
  bool after_rejection_ = false;
  std::uint64_t too_wrong_ = 0;
};

}  // namespace tandem::launch
