// Conclusions from the rows of a study: the order of the error, the front of the best settings, the cheapest
// setting with a sufficiently small error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "launch/study/plan.hpp"

namespace tandem::launch {

struct Row {
  PlannedRun run;
  std::string status;          // "ok", "suspect", "diverged", "failed", "died", "running", "timed_out"
  std::string problem;         // what ended it, or the objection of the verdict; empty where the run is ok
  std::vector<double> errors;  // one for each measure; NaN: unknown
  double cpu = 0;              // time of both solvers' own work, the median of its timings [s]
  nlohmann::json summary;      // summary.json, empty where the run left none
  double cpu_low = 0, cpu_high = 0;  // the shortest and the longest timing [s]
};

// Whether the row can be compared by measure `m`: its run completed, whatever its verdict.
bool counts(const Row& row, std::size_t m);

// Rows that differ in the step only.
struct Series {
  std::string label;                  // their common settings
  std::vector<double> steps, errors;  // ascending steps
  std::vector<double> orders;  // between neighbours: log of the errors' ratio over log of the steps' ratio
  std::optional<double> order() const;  // slope of a least-squares line through the logarithms
};
std::vector<Series> series_of(const std::vector<Row>& rows, const std::string& step, std::size_t measure);

// Indices of the rows that no other row improves in both error and CPU time, cheapest first.
std::vector<std::size_t> pareto_front(const std::vector<Row>& rows, std::size_t measure);

// The row with the least CPU time whose error is at most `error`.
std::optional<std::size_t> cheapest(const std::vector<Row>& rows, std::size_t measure, double error);

}  // namespace tandem::launch
