#include "coordinator/results/checks.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "common/error.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/utf8.hpp"
#include "coordinator/results/reduction.hpp"

namespace tandem::launch {
namespace {

double number_of_summary(const nlohmann::json& summary, const std::string& path) {
  const nlohmann::json* at = &summary;
  std::istringstream parts(path);
  for (std::string key; std::getline(parts, key, '.');) {
    if (!at->is_object() || !at->contains(key)) {
      std::vector<std::string> known;
      if (at->is_object()) {
        for (const auto& entry : at->items()) known.push_back(entry.key());
      }
      throw Error(ErrorCode::scene, "summary.json has no \"" + shortened(path) + "\"", {},
                  suggest_name(key, known, "keys"));
    }
    at = &at->at(key);
  }
  if (!at->is_number())
    throw Error(ErrorCode::scene, "\"" + shortened(path) + "\" of summary.json is no number");
  return at->get<double>();
}

// One number of a run: of a signal, reduced, or of the summary.
struct Quantity {
  std::size_t check;  // to which it belongs
  std::string of;
  const Signals* signals = nullptr;  // null: of the summary
  std::optional<Reduction> reduction{};
};

const Signals& signals_of(const std::string& of, const std::vector<const Signals*>& all) {
  std::vector<std::string> known;
  for (const Signals* signals : all) {
    if (signals->has(of)) return *signals;
    known.insert(known.end(), signals->names().begin(), signals->names().end());
  }
  throw Error(ErrorCode::scene, "there is no signal \"" + shortened(of) + "\"", {},
              suggest_name(of, known, "signals"));
}

// Calls `evaluate`; adds the name of the check to an Error.
template <class Function>
auto with_name(const std::vector<scene::Check>& checks, std::size_t i, Function evaluate) {
  try {
    return evaluate();
  } catch (const Error& error) {
    throw Error(error.code(), error.problem(),
                "checks[" + std::to_string(i) + "] \"" + shortened(checks[i].name) + "\"", error.hint());
  }
}

// Reads the rows of these signals once for all reductions (of `columns`, "time" first).
void pass(const Signals& signals, const std::vector<std::string>& columns,
          const std::vector<Reduction*>& reductions) {
  signals.visit(columns, [&](std::span<const double> values) {
    for (std::size_t i = 0; i < reductions.size(); ++i) reductions[i]->add(values[0], values[i + 1]);
  });
}

// Reads the rows of these signals for all quantities in them, a second time for those that need it.
void go_through(const Signals& signals, std::vector<Quantity>& quantities) {
  for (const bool again : {false, true}) {
    std::vector<std::string> columns{"time"};
    std::vector<Reduction*> there;
    for (Quantity& quantity : quantities) {
      if (quantity.signals != &signals || (again && !quantity.reduction->needs_second_pass())) continue;
      columns.push_back(quantity.of);
      there.push_back(&*quantity.reduction);
    }
    if (there.empty()) return;
    if (again)
      for (Reduction* reduction : there) reduction->end_of_pass();
    pass(signals, columns, there);
  }
}

CheckResult judge(const scene::Check& check, double value) {
  CheckResult result{check, value};
  result.error = std::abs(value - check.expected);
  if (!check.absolute && result.error != 0) result.error /= std::abs(check.expected);
  result.passed = result.error <= check.tolerance;  // false for NaN
  return result;
}

}  // namespace

std::vector<CheckResult> evaluate(const std::vector<scene::Check>& checks,
                                  const std::vector<const Signals*>& all, const nlohmann::json& summary) {
  const std::string of_summary = "summary.";
  std::vector<Quantity> quantities;
  const auto add = [&](std::size_t i, const std::string& of) {
    Quantity quantity{i, of};
    if (!of.starts_with(of_summary)) {
      quantity.signals = &signals_of(of, all);
      quantity.reduction.emplace(checks[i].reduce, checks[i].from, checks[i].to);
    }
    quantities.push_back(std::move(quantity));
  };
  for (std::size_t i = 0; i < checks.size(); ++i)
    with_name(checks, i, [&] {
      add(i, checks[i].of);
      if (!checks[i].expected_of.empty()) add(i, checks[i].expected_of);
    });
  for (const Signals* signals : all) go_through(*signals, quantities);

  const auto value = [&](const Quantity& quantity) {
    return with_name(checks, quantity.check, [&] {
      return quantity.reduction ? quantity.reduction->value()
                                : number_of_summary(summary, quantity.of.substr(of_summary.size()));
    });
  };
  std::vector<CheckResult> results;
  for (auto next = quantities.begin(); next != quantities.end();) {
    scene::Check check = checks[next->check];
    const double found = value(*next++);
    if (!check.expected_of.empty()) check.expected = check.times * value(*next++);
    results.push_back(judge(check, found));
  }
  return results;
}

}  // namespace tandem::launch
