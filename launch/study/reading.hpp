// What the rows of a study say: the order of the error, the front of the best settings, the cheapest that is
// good enough.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "launch/study/plan.hpp"

namespace tandem::launch {

struct Row {
  PlannedRun run;
  std::string status;          // "ok", "suspect", "diverged", "failed", "died", "timed_out"
  std::string problem;         // what ended it, or what the verdict objects to; empty where it is ok
  std::vector<double> errors;  // one for each measure; NaN: unknown
  double cpu = 0;              // time of both solvers' own work [s]
  nlohmann::json summary;      // summary.json, empty where the run left none
};

// The row can be compared by measure `m`: its run came to its end, whatever its verdict.
bool counts(const Row& row, std::size_t m);

// Rows that agree in all settings but the step.
struct Series {
  std::string label;                  // the settings that they agree in
  std::vector<double> steps, errors;  // ascending steps
  std::vector<double> orders;  // between neighbours: log of the errors' ratio over log of the steps' ratio
  std::optional<double> order() const;  // slope of a least-squares line through the logarithms
};
std::vector<Series> series_of(const std::vector<Row>& rows, const std::string& step, std::size_t measure);

// Indices of the rows that no other row beats in both error and CPU time, cheapest first.
std::vector<std::size_t> pareto_front(const std::vector<Row>& rows, std::size_t measure);

// The row with the least CPU time whose error is at most `error`.
std::optional<std::size_t> cheapest(const std::vector<Row>& rows, std::size_t measure, double error);

}  // namespace tandem::launch
