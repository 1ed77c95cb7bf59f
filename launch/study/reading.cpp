#include "launch/study/reading.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "coordinator/verdict/status.hpp"

namespace tandem::launch {

bool counts(const Row& row, std::size_t m) {
  return (row.status == name(Status::ok) || row.status == name(Status::suspect)) &&
         std::isfinite(row.errors[m]);
}

std::optional<double> Series::order() const {
  if (steps.size() < 2) return {};
  const auto n = static_cast<double>(steps.size());
  double x = 0, y = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    x += std::log(steps[i]) / n;
    y += std::log(errors[i]) / n;
  }
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double dx = std::log(steps[i]) - x;
    xx += dx * dx;
    xy += dx * (std::log(errors[i]) - y);
  }
  return xy / xx;
}

std::vector<Series> series_of(const std::vector<Row>& rows, const std::string& step, std::size_t measure) {
  std::vector<Series> all;
  for (const Row& row : rows) {
    std::string label;
    double size = 0;
    for (const Setting& setting : row.run.settings) {
      if (setting.name == step) {
        size = setting.value.get<double>();
        continue;
      }
      label += (label.empty() ? "" : " ") + setting.name + "=";
      label += setting.value.is_string() ? setting.value.get<std::string>() : setting.value.dump();
    }
    auto series = std::find_if(all.begin(), all.end(), [&](const Series& s) { return s.label == label; });
    if (series == all.end()) {
      all.push_back({label, {}, {}, {}});
      series = all.end() - 1;
    }
    if (!counts(row, measure) || row.errors[measure] == 0) continue;
    const auto place =
        std::lower_bound(series->steps.begin(), series->steps.end(), size) - series->steps.begin();
    series->steps.insert(series->steps.begin() + place, size);
    series->errors.insert(series->errors.begin() + place, row.errors[measure]);
  }
  for (Series& series : all)
    for (std::size_t i = 1; i < series.steps.size(); ++i)
      series.orders.push_back(std::log(series.errors[i] / series.errors[i - 1]) /
                              std::log(series.steps[i] / series.steps[i - 1]));
  return all;
}

std::vector<std::size_t> pareto_front(const std::vector<Row>& rows, std::size_t measure) {
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t i) { return !counts(rows[i], measure); });
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(rows[a].cpu, rows[a].errors[measure]) < std::pair(rows[b].cpu, rows[b].errors[measure]);
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order)
    if (front.empty() || rows[i].errors[measure] < rows[front.back()].errors[measure]) front.push_back(i);
  return front;
}

std::optional<std::size_t> cheapest(const std::vector<Row>& rows, std::size_t measure, double error) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!counts(rows[i], measure) || rows[i].errors[measure] > error) continue;
    if (!best || rows[i].cpu < rows[*best].cpu) best = i;
  }
  return best;
}

}  // namespace tandem::launch
