#include "coordinator/run/stopwatch.hpp"

#include <algorithm>

namespace tandem::launch {

Stopwatch::Reading Stopwatch::read(const Solvers& solvers) {
  Reading reading;
  const auto add = [&](protocol::Role role, double& wait) {
    const protocol::Remote* solver = solvers.of(role);
    if (!solver) return;
    wait = solver->wait_seconds();
    reading.exchange += solver->exchange_seconds();
  };
  add(protocol::Role::mbd, reading.mbd_wait);
  add(protocol::Role::dem, reading.dem_wait);
  add(protocol::Role::sph, reading.sph_wait);
  return reading;
}

void Stopwatch::start(const Solvers& solvers) {
  begin_ = std::chrono::steady_clock::now();
  apart_ = now_ = read(solvers);
}

void Stopwatch::begin_output(const Solvers& solvers) {
  output_begin_ = std::chrono::steady_clock::now();
  before_output_ = read(solvers);
}

void Stopwatch::end_output(const Solvers& solvers) {
  output_ += seconds_since(output_begin_);
  wall_ = seconds_since(begin_);
  now_ = read(solvers);
  apart_.mbd_wait += now_.mbd_wait - before_output_.mbd_wait;
  apart_.dem_wait += now_.dem_wait - before_output_.dem_wait;
  apart_.sph_wait += now_.sph_wait - before_output_.sph_wait;
  apart_.exchange += now_.exchange - before_output_.exchange;
}

TimeSplit Stopwatch::split(double mbd_own, double dem_own, double sph_own) const {
  TimeSplit split;
  split.output = output_;
  split.exchange = now_.exchange - apart_.exchange;
  const auto divide = [&split](double wait, double own) {
    // A solver that works while the other one is waited for has more work time than waiting time.
    const double work = own > 0 ? std::min(own, wait) : wait;
    split.exchange += wait - work;  // transfer and wake-up
    return work;
  };
  split.mbd = divide(now_.mbd_wait - apart_.mbd_wait, mbd_own);
  split.dem = divide(now_.dem_wait - apart_.dem_wait, dem_own);
  split.sph = divide(now_.sph_wait - apart_.sph_wait, sph_own);
  return split;
}

}  // namespace tandem::launch
