// How long the next window is. Without `adaptive` every window is as long as the scene says. With it the
// window follows the error of the last one: a proportional-integral rule as for ordinary step sizes
// (Soederlind, Numer. Algorithms 31, 2002; for energy residuals of a coupling: Sadjina et al., Eng. Comput.
// 33, 2017), but a window that was too wrong is taken back on both sides and repeated with a shorter one.
#pragma once

#include <optional>

#include "common/scene/model.hpp"
#include "common/time.hpp"
#include "launch/coordinator/archive.hpp"

namespace tandem::launch {

// What a window got wrong, in absolute terms.
struct WindowError {
  double energy = 0;     // |energy created| [J]
  double exchanged = 0;  // energy exchanged [J]
  double path = 0;       // largest distance between the path seen and the path taken [m]
};

class WindowControl {
 public:
  explicit WindowControl(const scene::Coupling& coupling);

  bool adaptive() const { return adaptive_.has_value(); }
  // The end of the window that begins now; not beyond `limit`.
  Nanoseconds end(Nanoseconds now, Nanoseconds limit) const;
  // Whether a window of this error may stay; sets the length of the next one, or of its repetition.
  // `micro_step` is the particles' step [s]: windows are a whole number of them. `stable` is the longest
  // window that suits the contacts [s].
  bool accept(const Window& window, const WindowError& error, double micro_step, double stable);
  // The window could not be computed: shorter, if there is anything shorter.
  bool shorten(const Window& window, double micro_step);
  // Windows that stayed although they were too wrong, because no shorter one is allowed, or holds a micro
  // step.
  std::uint64_t too_wrong() const { return too_wrong_; }
  void keep(Archive& archive);

 private:
  void set_length(double length, double micro_step);
  // Whether the window is done again, shorter by that factor.
  bool reject(const Window& window, double factor, double micro_step);

  std::optional<scene::Adaptive> adaptive_;
  Nanoseconds length_;
  double last_error_ = 1;            // relative to what is allowed [-]
  double exchanged_ = 0, time_ = 0;  // over the run [J] [s]
  bool after_rejection_ = false;
  std::uint64_t too_wrong_ = 0;
};

}  // namespace tandem::launch
