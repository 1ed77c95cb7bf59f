// Measures the parts of the wall time of the windows.
#pragma once

#include <chrono>

#include "coordinator/schemes/schemes.hpp"

namespace tandem::launch {

inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Wall time of the windows by its use [s].
struct TimeSplit {
  double mbd = 0, dem = 0, sph = 0;  // waiting for the solver's own work
  double exchange = 0;               // encoding, copying, waking up
  double output = 0;  // observing the solvers, writing rows, waiting for frames that are being written
};

class Stopwatch {
 public:
  // Call when the windows begin.
  void start(const Solvers& solvers);
  bool started() const { return begin_ != Time{}; }
  // Between these two calls, at the end of each window, the solvers are observed and files are written.
  void begin_output(const Solvers& solvers);
  void end_output(const Solvers& solvers);

  double wall() const { return wall_; }  // of the complete windows [s]
  // Work time that the solvers report [s]; 0 where they report none. Where both kinds of particles are there,
  // they advance at the same time: the second one is waited for only as long as it takes longer.
  TimeSplit split(double mbd_own, double dem_own, double sph_own) const;

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Reading {
    double mbd_wait = 0, dem_wait = 0, sph_wait = 0, exchange = 0;  // [s]
  };
  static Reading read(const Solvers& solvers);

  Time begin_, output_begin_;
  Reading apart_;  // before the windows, and while observing
  Reading before_output_, now_;
  double wall_ = 0, output_ = 0;
};

}  // namespace tandem::launch
