// What acted on the bodies from outside in each window of a run, from which the run can be repeated alone:
// loads of particles and inputs of a controller; and the coordinates to which they led.
#pragma once

#include <algorithm>
#include <vector>

#include "common/time.hpp"
#include "mbd_server/state/state.hpp"

namespace tandem::mbd {

class LoadJournal {
 public:
  // Begins a run of about so many windows, for which nothing will be allocated.
  LoadJournal() = default;
  LoadJournal(double windows, const State& state)
      : width_(static_cast<std::size_t>(2 * state.loads.size() + state.inputs.size() + state.q.size())) {
    windows_.reserve(static_cast<std::size_t>(std::min(windows, static_cast<double>(fit()))) + 1);
    values_.reserve(windows_.capacity() * width_);
  }

  // Forgets all windows but the first `windows`, as where a run goes back.
  void keep(std::size_t windows) {
    windows_.resize(std::min(windows, windows_.size()));
    values_.resize(windows_.size() * width_);
  }
  std::size_t size() const { return windows_.size(); }
  // False: a window was left out, and the run cannot be repeated.
  bool complete() const { return complete_; }

  // Notes loads and inputs of `state`, which acted in the window, and its coordinates, at its end.
  void note(const Window& window, const State& state) {
    complete_ = complete_ && windows_.size() < fit();
    if (!complete_) return;
    windows_.push_back(window);
    append(state.inputs), append(state.loads), append(state.load_rates), append(state.q);
  }

  const Window& window(std::size_t k) const { return windows_[k]; }
  Eigen::Map<const VectorXd> inputs(std::size_t k, const State& state) const {
    return {values_.data() + k * width_, state.inputs.size()};
  }
  // Sets the loads of window k.
  void load(std::size_t k, State& state) const {
    const double* from = values_.data() + k * width_ + state.inputs.size();
    std::copy_n(from, state.loads.size(), state.loads.data());
    std::copy_n(from + state.loads.size(), state.load_rates.size(), state.load_rates.data());
  }
  // At the end of window k.
  Eigen::Map<const VectorXd> coordinates(std::size_t k, const State& state) const {
    return {values_.data() + (k + 1) * width_ - state.q.size(), state.q.size()};
  }

 private:
  // As many windows as 64 MiB hold.
  std::size_t fit() const { return (std::size_t{1} << 26) / (sizeof(Window) + width_ * sizeof(double)); }

  template <class Values>
  void append(const Values& values) {
    values_.insert(values_.end(), values.data(), values.data() + values.size());
  }

  std::vector<Window> windows_;
  std::vector<double> values_;  // width_ for each window
  std::size_t width_ = 0;
  bool complete_ = true;
};

}  // namespace tandem::mbd
