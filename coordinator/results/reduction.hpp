// Reduces a part of a signal to one number, row by row: no row is stored.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tandem::launch {

class Reduction {
 public:
  // `how`: last, mean, rms, mean_abs, min, max, range or period, as `reduce` of scene::Check; throws
  // Error{scene} for another word. The part from `from` to `to` [s]; `to` <= 0 means the end.
  Reduction(std::string how, double from, double to);

  void add(double time, double value);
  // A period is measured about the mean: the rows have to be given a second time, after end_of_pass().
  bool needs_second_pass() const { return how_ == "period"; }
  void end_of_pass();
  // Throws Error{scene} where the part has no row.
  double value() const;

 private:
  double integrand(double value) const;
  double mean() const;

  std::string how_;
  double from_, to_;  // [s]
  std::uint64_t rows_ = 0;
  double first_time_ = 0, last_time_ = 0, last_value_ = 0, least_ = 0, largest_ = 0, integral_ = 0;
  // Second pass: upward crossings of the mean.
  bool second_ = false;
  double level_ = 0, first_crossing_ = 0, last_crossing_ = 0;
  std::uint64_t crossings_ = 0;
};

// Reduces a whole signal in memory.
double reduce(const std::vector<double>& time, const std::vector<double>& value, const std::string& how,
              double from, double to);

}  // namespace tandem::launch
