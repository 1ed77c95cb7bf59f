#include "coordinator/results/reduction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "common/error.hpp"
#include "common/scene/nearest_name.hpp"

namespace tandem::launch {
namespace {

// Times in a file are rounded decimals; half a nanosecond is the tolerance of the range.
constexpr double time_tolerance = 0.5e-9;  // [s]

const std::vector<std::string>& words() {
  static const std::vector<std::string> all{"last", "mean", "rms",   "mean_abs",
                                            "min",  "max",  "range", "period"};
  return all;
}

}  // namespace

Reduction::Reduction(std::string how, double from, double to) : how_(std::move(how)), from_(from), to_(to) {
  if (std::find(words().begin(), words().end(), how_) == words().end())
    throw Error(ErrorCode::scene, "unknown reduction \"" + how_ + "\"", {},
                suggest_name(how_, words(), "reductions"));
}

void Reduction::add(double time, double value) {
  const double end = to_ > 0 ? to_ : std::numeric_limits<double>::infinity();
  if (time < from_ - time_tolerance || time > end + time_tolerance) return;
  if (rows_ == 0) {
    first_time_ = time;
    least_ = largest_ = value;
  } else if (second_) {
    const double before = last_value_ - level_, after = value - level_;
    if (before < 0 && after >= 0) {
      last_crossing_ = last_time_ + before / (before - after) * (time - last_time_);
      if (crossings_++ == 0) first_crossing_ = last_crossing_;
    }
  } else {
    integral_ += 0.5 * (integrand(last_value_) + integrand(value)) * (time - last_time_);
    // A NaN is kept: no later value is smaller or larger.
    if (value < least_ || std::isnan(value)) least_ = value;
    if (value > largest_ || std::isnan(value)) largest_ = value;
  }
  last_time_ = time;
  last_value_ = value;
  ++rows_;
}

void Reduction::end_of_pass() {
  level_ = rows_ > 0 ? mean() : 0;
  second_ = true;
  rows_ = 0;
}

// What is averaged over time.
double Reduction::integrand(double value) const {
  if (how_ == "rms") return value * value;
  return how_ == "mean_abs" ? std::abs(value) : value;
}

double Reduction::mean() const {
  return rows_ == 1 ? integrand(last_value_) : integral_ / (last_time_ - first_time_);
}

double Reduction::value() const {
  if (rows_ == 0) {
    std::ostringstream range;
    range << "no window ends in the range from " << from_ << " s to ";
    if (to_ > 0)
      range << to_ << " s";
    else
      range << "the end";
    throw Error(ErrorCode::scene, range.str());
  }
  if (how_ == "last") return last_value_;
  if (how_ == "mean" || how_ == "mean_abs") return mean();
  if (how_ == "rms") return std::sqrt(mean());
  if (how_ == "min") return least_;
  if (how_ == "max") return largest_;
  if (how_ == "range") return largest_ - least_;
  if (crossings_ < 2) return std::numeric_limits<double>::quiet_NaN();
  return (last_crossing_ - first_crossing_) / static_cast<double>(crossings_ - 1);
}

double reduce(const std::vector<double>& time, const std::vector<double>& value, const std::string& how,
              double from, double to) {
  Reduction reduction(how, from, to);
  const auto pass = [&] {
    for (std::size_t i = 0; i < time.size(); ++i) reduction.add(time[i], value[i]);
  };
  pass();
  if (reduction.needs_second_pass()) {
    reduction.end_of_pass();
    pass();
  }
  return reduction.value();
}

}  // namespace tandem::launch
