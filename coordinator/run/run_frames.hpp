// The frames of a run: taken from the solvers, checked, and given to the results.
#pragma once

#include <optional>

#include "common/scene/model.hpp"
#include "coordinator/results/results.hpp"
#include "coordinator/run/grain_watches.hpp"
#include "coordinator/run/stopwatch.hpp"
#include "coordinator/run_folder/run_folder.hpp"

namespace tandem::launch {

// A place in a run between two windows.
struct BetweenWindows {
  Nanoseconds time;
  const protocol::BodiesFrame* bodies = nullptr;  // observed at that time; null without bodies
  const Exchange* window = nullptr;  // the last one, with the loads of the grains; null before the first
};

class RunFrames {
 public:
  // All of them live as long as the frames. The thread of `results` uses what is here: it must end first.
  RunFrames(const scene::Scene& scene, const Solvers& solvers, std::optional<GrainWatches>& watches,
            RunFolder& folder, Results& results, Stopwatch& stopwatch)
      : scene_(scene),
        solvers_(solvers),
        watches_(watches),
        folder_(folder),
        results_(results),
        stopwatch_(stopwatch) {}

  Nanoseconds next() const { return next_; }  // beyond the end of the scene where none is left
  Nanoseconds last() const { return last_; }

  // A frame at once.
  void write(const BetweenWindows& now);
  // A frame that the solvers prepare during the next windows, where all of them can; else one at once.
  void begin(const BetweenWindows& now);
  // After each window: a frame that was begun is fetched some windows later, before the next one is due.
  void after_window(Nanoseconds now);
  // Fetches the frame that was begun, if there is one.
  void fetch();

 private:
  struct Begun {
    Nanoseconds time;
    std::optional<protocol::BodiesFrame> bodies;
    GrainWatches::FrameCheck check;
    int windows = 0;  // since then
  };
  static constexpr int windows_of_a_frame = 3;

  bool have(protocol::Role role) const;
  bool can_begin() const;
  void set_next(Nanoseconds now);

  const scene::Scene& scene_;
  const Solvers& solvers_;
  std::optional<GrainWatches>& watches_;
  RunFolder& folder_;
  Results& results_;
  Stopwatch& stopwatch_;

  protocol::ReceivedParticles received_;
  Nanoseconds next_, last_;
  std::optional<Begun> begun_;
};

}  // namespace tandem::launch
