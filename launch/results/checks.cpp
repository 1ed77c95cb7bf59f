#include "launch/results/checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/error.hpp"
#include "common/scene/nearest_name.hpp"

namespace tandem::launch {
namespace {

// Times in a file are written in decimals; half a nanosecond settles whether a row belongs to the range.
constexpr double time_tolerance = 0.5e-9;  // [s]

struct Part {
  std::vector<double> time, value;
};

Part part_of(const std::vector<double>& time, const std::vector<double>& value, double from, double to) {
  const double end = to > 0 ? to : std::numeric_limits<double>::infinity();
  Part part;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (time[i] < from - time_tolerance || time[i] > end + time_tolerance) continue;
    part.time.push_back(time[i]);
    part.value.push_back(value[i]);
  }
  return part;
}

double time_mean(const Part& part) {
  if (part.time.size() == 1) return part.value.front();
  double integral = 0;
  for (std::size_t i = 1; i < part.time.size(); ++i) {
    integral += 0.5 * (part.value[i - 1] + part.value[i]) * (part.time[i] - part.time[i - 1]);
  }
  return integral / (part.time.back() - part.time.front());
}

// Mean distance of the upward crossings of the mean; NaN where there are fewer than two.
double period(const Part& part) {
  const double level = time_mean(part);
  double first = 0, last = 0;
  int crossings = 0;
  for (std::size_t i = 1; i < part.time.size(); ++i) {
    const double before = part.value[i - 1] - level, after = part.value[i] - level;
    if (before >= 0 || after < 0) continue;
    last = part.time[i - 1] + before / (before - after) * (part.time[i] - part.time[i - 1]);
    if (crossings++ == 0) first = last;
  }
  return crossings < 2 ? std::numeric_limits<double>::quiet_NaN() : (last - first) / (crossings - 1);
}

double number_of_summary(const nlohmann::json& summary, const std::string& path) {
  const nlohmann::json* at = &summary;
  std::istringstream parts(path);
  for (std::string key; std::getline(parts, key, '.');) {
    if (!at->is_object() || !at->contains(key)) {
      std::vector<std::string> known;
      if (at->is_object()) {
        for (const auto& entry : at->items()) known.push_back(entry.key());
      }
      throw Error(ErrorCode::scene, "summary.json has no \"" + path + "\"", {},
                  suggest_name(key, known, "keys"));
    }
    at = &at->at(key);
  }
  if (!at->is_number()) throw Error(ErrorCode::scene, "\"" + path + "\" of summary.json is no number");
  return at->get<double>();
}

double value_of(const scene::Check& check, const Signals& bodies, const Signals& joints,
                const nlohmann::json& summary) {
  const std::string prefix = "summary.";
  if (check.of.starts_with(prefix)) return number_of_summary(summary, check.of.substr(prefix.size()));
  for (const Signals* signals : {&bodies, &joints}) {
    if (!signals->has(check.of)) continue;
    return reduce(signals->column("time"), signals->column(check.of), check.reduce, check.from, check.to);
  }
  std::vector<std::string> known = bodies.names();
  known.insert(known.end(), joints.names().begin(), joints.names().end());
  throw Error(ErrorCode::scene, "there is no signal \"" + check.of + "\"", {},
              suggest_name(check.of, known, "signals"));
}

CheckResult judge(const scene::Check& check, double value) {
  CheckResult result{check, value};
  result.error = std::abs(value - check.expected);
  if (!check.absolute && result.error != 0) result.error /= std::abs(check.expected);
  result.passed = result.error <= check.tolerance;  // false for NaN
  return result;
}

}  // namespace

double reduce(const std::vector<double>& time, const std::vector<double>& value, const std::string& reduce,
              double from, double to) {
  const Part part = part_of(time, value, from, to);
  if (part.time.empty()) {
    std::ostringstream range;
    range << "no window ends in the range from " << from << " s to ";
    if (to > 0)
      range << to << " s";
    else
      range << "the end";
    throw Error(ErrorCode::scene, range.str());
  }
  const auto [least, largest] = std::minmax_element(part.value.begin(), part.value.end());
  if (reduce == "last") return part.value.back();
  if (reduce == "mean") return time_mean(part);
  if (reduce == "min") return *least;
  if (reduce == "max") return *largest;
  if (reduce == "range") return *largest - *least;
  if (reduce == "period") return period(part);
  throw Error(ErrorCode::scene, "unknown reduction \"" + reduce + "\"", {},
              suggest_name(reduce, {"last", "mean", "min", "max", "range", "period"}, "reductions"));
}

std::vector<CheckResult> evaluate(const std::vector<scene::Check>& checks, const Signals& bodies,
                                  const Signals& joints, const nlohmann::json& summary) {
  std::vector<CheckResult> results;
  for (std::size_t i = 0; i < checks.size(); ++i) {
    try {
      results.push_back(judge(checks[i], value_of(checks[i], bodies, joints, summary)));
    } catch (const Error& error) {
      throw Error(error.code(), error.problem(),
                  "checks[" + std::to_string(i) + "] \"" + checks[i].name + "\"", error.hint());
    }
  }
  return results;
}

}  // namespace tandem::launch
