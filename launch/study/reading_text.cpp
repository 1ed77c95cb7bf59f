#include "launch/study/reading_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "coordinator/verdict/status.hpp"
#include "launch/study/explicit_method.hpp"

namespace tandem::launch {
namespace {

std::string counted(const std::vector<Row>& rows) {
  std::map<std::string, int> count;
  for (const Row& row : rows) ++count[row.status];
  std::string text;
  for (const auto& [status, n] : count) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, status);
  return text;
}

}  // namespace

std::string row_text(const Row& row, std::size_t m) {
  std::string time = std::isfinite(row.cpu) ? fmt::format("{:.4g} s", row.cpu) : "time not reported";
  if (row.cpu_low < row.cpu_high) time += fmt::format(" ({:.4g} to {:.4g} s)", row.cpu_low, row.cpu_high);
  return fmt::format("error {:.3g}, {}: {}{}\n", row.errors[m], time, row.run.label(),
                     row.status == name(Status::suspect) ? " (suspect: " + row.problem + ")" : "");
}

std::string reading_of(const Study& study, const Plan& plan, const std::vector<Row>& rows) {
  std::string text =
      fmt::format("{} rows: {}; times are processor time of the solvers\n", rows.size(), counted(rows));
  for (std::size_t m = 0; m < study.measures.size(); ++m) {
    const Measure& measure = study.measures[m];
    text += fmt::format("\n{}{}\n", measure.name, measure.unit.empty() ? "" : " [" + measure.unit + "]");
    if (!study.order_in.empty()) {
      for (const Series& series : series_of(rows, study.order_in, m)) {
        const std::string label = series.label.empty() ? "" : "  " + series.label;
        const auto order = series.order();
        if (!order) {
          text += fmt::format("  order in {}{}: not enough rows\n", study.order_in, label);
          continue;
        }
        text +=
            fmt::format("  order in {}{}: {:.2f}, from small to large steps", study.order_in, label, *order);
        for (const double o : series.orders) text += fmt::format(" {:.2f}", o);
        text += "\n";
      }
    }
    for (const std::size_t i : pareto_front(rows, m)) text += "  front: " + row_text(rows[i], m);
    text += compare_methods(rows, m);
  }
  if (plan.try_explicit_method)
    text +=
        "\nthe machine has no closed loops and no limits: sweep 'method' with the values generalized_alpha "
        "and "
        "dormand_prince, which is faster where nothing is stiff\n";
  return text;
}

}  // namespace tandem::launch
