#include "coordinator/verdict/verdict.hpp"

#include <fmt/format.h>

#include <cmath>

#include "coordinator/verdict/rules.hpp"

namespace tandem::launch {

std::optional<double> RunFigures::number(const char* key) const {
  const auto found = summary.find(key);
  if (found == summary.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

const std::vector<Rule>& rules() {
  static const std::vector<Rule> table = [] {
    std::vector<Rule> all;
    add_coupling_rules(all);
    add_mbd_rules(all);
    add_particle_rules(all);
    add_account_rules(all);
    add_liquid_rules(all);
    return all;
  }();
  return table;
}

Verdict judge(const RunFigures& run) {
  Verdict verdict;
  for (const Rule& rule : rules()) {
    const auto figures = rule.measure(run);
    if (!figures) continue;
    verdict.judged.emplace_back(rule.name);
    const double limit = rule.limit_of ? rule.limit_of(run.scene) : rule.limit;
    for (const Figure& figure : *figures)
      if (!(figure.value <= limit))
        verdict.lines.push_back(
            {rule.name, figure.of, figure.value, limit, rule.sentence(run, figure, limit)});
  }
  return verdict;
}

nlohmann::ordered_json to_json(const Verdict& verdict) {
  nlohmann::ordered_json lines = nlohmann::ordered_json::array();
  for (const VerdictLine& line : verdict.lines)
    lines.push_back({{"rule", line.rule},
                     {"of", line.of},
                     {"value", line.value},
                     {"limit", line.limit},
                     {"sentence", line.sentence}});
  return {{"status", verdict.suspect() ? "suspect" : "ok"},
          {"judged", verdict.judged},
          {"lines", lines},
          {"not_judged", verdict.not_judged}};
}

std::string rules_as_markdown() {
  std::string text =
      "| rule | figure of `summary.json` | limit | why this limit | what a line says to use "
      "|\n|---|---|---|---|---|\n";
  for (const Rule& rule : rules())
    text += fmt::format("| {} | `{}` | {} | {} | {} |\n", rule.name, rule.figure,
                        std::isfinite(rule.limit) ? fmt::format("{:.3g}", rule.limit) : "none", rule.reason,
                        rule.instead);
  return text;
}

}  // namespace tandem::launch
