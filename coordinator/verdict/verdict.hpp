// The verdict on a run: rules that compare figures of its summary with limits. A completed run with an
// objection of a rule is `suspect`. The rules are in one table, by subject (rules.hpp); docs/verdict.md has
// the same table, and a test compares the two.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "protocol/facts.hpp"

namespace tandem::launch {

// Input of a rule: the scene, what the coordinator measured (keys of summary.json), and what the solvers
// reported.
struct RunFigures {
  const scene::Scene& scene;
  const nlohmann::ordered_json& summary;
  const protocol::SolverFacts& facts;

  // What the coordinator measured, by its key; none where the key is absent or null.
  std::optional<double> number(const char* key) const;
};

// A figure of one object: a body, a joint, a wall, or the run as a whole.
struct Figure {
  std::string of;    // "body 'wheel'"
  double value = 0;  // [-] unless the rule says otherwise
};

struct Rule {
  const char* name;
  const char* figure;   // the formula, of keys of the summary
  double limit;         // of the value; a NaN exceeds every limit
  const char* reason;   // of the limit
  const char* instead;  // advice in the line of this rule
  // Limit of this scene, where the scene sets one; null: `limit`.
  double (*limit_of)(const scene::Scene& scene);
  // The figures, one per object; none where the run lacks them: then the rule is not judged.
  std::optional<std::vector<Figure>> (*measure)(const RunFigures& run);
  // The problem, and the value to use instead.
  std::string (*sentence)(const RunFigures& run, const Figure& figure, double limit);
};
const std::vector<Rule>& rules();

struct VerdictLine {
  std::string rule, of;
  double value = 0, limit = 0;
  std::string sentence;
};
struct Verdict {
  std::vector<std::string> judged;      // names of the rules whose figures the run has
  std::vector<VerdictLine> lines;       // objections
  std::vector<std::string> not_judged;  // what is not judged, and why

  bool suspect() const { return !lines.empty(); }
};
Verdict judge(const RunFigures& run);

// The form of `verdict` in summary.json.
nlohmann::ordered_json to_json(const Verdict& verdict);

// The table of rules in the form of docs/verdict.md.
std::string rules_as_markdown();

}  // namespace tandem::launch
