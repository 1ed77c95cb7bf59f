// Where the wall time of the windows goes.
#pragma once

#include <chrono>

#include "launch/coordinator/schemes.hpp"

namespace tandem::launch {

inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Wall time of the windows by what it was spent on [s].
struct TimeSplit {
  double mbd = 0, dem = 0;  // waiting for the solver's own work
  double exchange = 0;      // encoding, copying, waking up
  double output = 0;  // observing the solvers, writing rows and waiting for frames that are being written
};

class Stopwatch {
 public:
  // The windows begin now.
  void start(const Solvers& solvers);
  bool started() const { return begin_ != Time{}; }
  // Between these two, at the end of each window, the solvers are observed and files are written.
  void begin_output(const Solvers& solvers);
  void end_output(const Solvers& solvers);

  double wall() const { return wall_; }  // of the complete windows [s]
  // `mbd_own`, `dem_own`: seconds that the solvers say they have worked; 0 where they do not say.
  TimeSplit split(double mbd_own, double dem_own) const;

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Reading {
    double mbd_wait = 0, dem_wait = 0, exchange = 0;  // [s]
  };
  static Reading read(const Solvers& solvers);

  Time begin_, output_begin_;
  Reading apart_;  // before the windows, and while observing
  Reading before_output_, now_;
  double wall_ = 0, output_ = 0;
};

}  // namespace tandem::launch
