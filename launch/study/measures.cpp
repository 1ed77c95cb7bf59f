#include "launch/study/measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "coordinator/results/reduction.hpp"

namespace tandem::launch {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> columns_of(const std::vector<Measure>& measures) {
  std::vector<std::string> columns;
  for (const Measure& measure : measures)
    if (!measure.of_summary()) columns.insert(columns.end(), measure.of.begin(), measure.of.end());
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  return columns;
}

// Values at `times`. Times are ends of windows, rounded to decimals: half a nanosecond is the tolerance.
// Empty where the run ended before the last of them.
std::vector<double> sampled(const SignalSet& set, const std::string& column,
                            const std::vector<double>& times) {
  const std::vector<double>& values = set.column.at(column);
  std::vector<double> samples;
  for (const double time : times) {
    const auto row = std::lower_bound(set.time.begin(), set.time.end(), time - 0.5e-9);
    if (row == set.time.end()) return {};
    if (std::abs(*row - time) > 0.5e-9)
      throw Error(ErrorCode::scene, "no window ends at " + std::to_string(time) + " s",
                  "signal '" + column + "'", "choose windows that divide the times of the reference");
    samples.push_back(values[static_cast<std::size_t>(row - set.time.begin())]);
  }
  return samples;
}

double summary_error(const Measure& measure, const nlohmann::json& summary) {
  nlohmann::json::json_pointer at("/" + measure.of.front().substr(std::string("summary.").size()));
  const bool known = summary.contains(at) && summary.at(at).is_number();
  return known ? std::abs(summary.at(at).get<double>() - measure.expected) : unknown;
}

double figure_error(const Measure& measure, const SignalSet& run, const Truth& truth) {
  const std::string& column = measure.of.front();
  const double end = truth.times.back();
  if (run.time.empty() || run.time.back() < end - 0.5e-9) return unknown;
  const auto figure = [&](const SignalSet& set) {
    return reduce(set.time, set.column.at(column), measure.error, measure.from, end);
  };
  return std::abs(figure(run) - figure(truth.whole));
}

// Length of the vector of differences at each time; then the largest, the root of the mean square, or the
// last.
double course_error(const Measure& measure, const SignalSet& run, const Truth& truth) {
  std::vector<double> squares(truth.times.size(), 0.0);
  for (const std::string& column : measure.of) {
    const std::vector<double> samples = sampled(run, column, truth.times);
    if (samples.empty()) return unknown;
    const std::vector<double>& right = truth.signals.at(column);
    for (std::size_t i = 0; i < squares.size(); ++i)
      squares[i] += (samples[i] - right[i]) * (samples[i] - right[i]);
  }
  if (measure.error == "last") return std::sqrt(squares.back());
  double largest = 0, sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < squares.size(); ++i) {
    if (truth.times[i] < measure.from - 0.5e-9) continue;
    largest = std::max(largest, squares[i]);
    sum += squares[i];
    ++count;
  }
  if (count == 0) return unknown;
  return std::sqrt(measure.error == "rms" ? sum / count : largest);
}

}  // namespace

Truth truth_of_table(const TableReference& table) {
  Truth truth;
  truth.times = table.times;
  for (const auto& signal : table.signals) truth.signals[signal.column] = signal.values;
  return truth;
}

Truth truth_of_run(const std::filesystem::path& folder, const std::vector<Measure>& measures,
                   const std::vector<double>& times) {
  Truth truth;
  truth.times = times;
  const std::vector<std::string> columns = columns_of(measures);
  truth.whole = read_signals(folder, columns);
  for (const std::string& column : columns) {
    truth.signals[column] = sampled(truth.whole, column, times);
    if (truth.signals[column].empty())
      throw Error(ErrorCode::scene, "the reference ends before " + std::to_string(times.back()) + " s",
                  folder.string(), "give a run that comes to its end");
  }
  return truth;
}

std::vector<double> errors_of_run(const std::filesystem::path& folder, const nlohmann::json& summary,
                                  const std::vector<Measure>& measures, const Truth& truth) {
  const std::vector<std::string> columns = columns_of(measures);
  const SignalSet run = columns.empty() ? SignalSet{} : read_signals(folder, columns);
  std::vector<double> errors;
  for (const Measure& measure : measures) {
    if (measure.of_summary())
      errors.push_back(summary_error(measure, summary));
    else
      errors.push_back(measure.of_figure() ? figure_error(measure, run, truth)
                                           : course_error(measure, run, truth));
  }
  return errors;
}

}  // namespace tandem::launch
