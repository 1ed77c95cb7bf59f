#include "launch/results/checks.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "common/error.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/utf8.hpp"
#include "launch/results/reduction.hpp"

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

// The signals that a check uses.
const Signals* signals_of(const scene::Check& check, const std::vector<const Signals*>& all) {
  std::vector<std::string> known;
  for (const Signals* signals : all) {
    if (signals->has(check.of)) return signals;
    known.insert(known.end(), signals->names().begin(), signals->names().end());
  }
  throw Error(ErrorCode::scene, "there is no signal \"" + shortened(check.of) + "\"", {},
              suggest_name(check.of, known, "signals"));
}

CheckResult judge(const scene::Check& check, double value) {
  CheckResult result{check, value};
  result.error = std::abs(value - check.expected);
  if (!check.absolute && result.error != 0) result.error /= std::abs(check.expected);
  result.passed = result.error <= check.tolerance;  // false for NaN
  return result;
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

// Reads the rows of these signals for all checks that use them, a second time for those that need it.
void go_through(const Signals& signals, const std::vector<scene::Check>& checks,
                const std::vector<const Signals*>& looks_at,
                std::vector<std::optional<Reduction>>& reductions) {
  for (const bool again : {false, true}) {
    std::vector<std::string> columns{"time"};
    std::vector<Reduction*> there;
    for (std::size_t i = 0; i < checks.size(); ++i) {
      if (looks_at[i] != &signals || (again && !reductions[i]->needs_second_pass())) continue;
      columns.push_back(checks[i].of);
      there.push_back(&*reductions[i]);
    }
    if (there.empty()) return;
    if (again)
      for (Reduction* reduction : there) reduction->end_of_pass();
    pass(signals, columns, there);
  }
}

}  // namespace

std::vector<CheckResult> evaluate(const std::vector<scene::Check>& checks,
                                  const std::vector<const Signals*>& all, const nlohmann::json& summary) {
  const std::string of_summary = "summary.";
  std::vector<const Signals*> looks_at(checks.size());
  std::vector<std::optional<Reduction>> reductions(checks.size());
  for (std::size_t i = 0; i < checks.size(); ++i) {
    if (checks[i].of.starts_with(of_summary)) continue;
    with_name(checks, i, [&] {
      looks_at[i] = signals_of(checks[i], all);
      reductions[i].emplace(checks[i].reduce, checks[i].from, checks[i].to);
    });
  }
  for (const Signals* signals : all) go_through(*signals, checks, looks_at, reductions);

  std::vector<CheckResult> results;
  for (std::size_t i = 0; i < checks.size(); ++i) {
    const double value = with_name(checks, i, [&] {
      return reductions[i] ? reductions[i]->value()
                           : number_of_summary(summary, checks[i].of.substr(of_summary.size()));
    });
    results.push_back(judge(checks[i], value));
  }
  return results;
}

}  // namespace tandem::launch
