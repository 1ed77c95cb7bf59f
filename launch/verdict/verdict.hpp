// The verdict on a run: rules that look at figures of its summary and object to those beyond a limit. A run
// that came to its end and to which a rule objects is `suspect`. The rules stand in one table, in
// verdict.cpp; docs/verdict.md has the same table for people, which a test compares.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::launch {

// What a rule judges by: the scene, and the summary of its run (keys of summary.json).
struct RunFigures {
  const scene::Scene& scene;
  const nlohmann::ordered_json& summary;

  // A number of the summary by its key; none where the run does not have it, or has null.
  std::optional<double> number(const char* key) const;
};

// A figure of one thing: a body, a joint, a wall, or the run as a whole.
struct Figure {
  std::string of;    // "body 'wheel'"
  double value = 0;  // [-] unless the rule says otherwise
};

struct Rule {
  const char* name;
  const char* figure;   // the formula, of keys of the summary
  double limit;         // of the value; a NaN is beyond any
  const char* reason;   // of the limit
  const char* instead;  // what a line of this rule says to use instead
  // Limit of this scene, where the scene sets one; null: `limit`.
  double (*limit_of)(const scene::Scene& scene);
  // The figures, one per thing; none where the run does not have them: then the rule is not judged.
  std::optional<std::vector<Figure>> (*measure)(const RunFigures& run);
  // What is wrong, and the value to use instead.
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
  std::vector<std::string> not_judged;  // what nothing is said about, and why

  bool suspect() const { return !lines.empty(); }
};
Verdict judge(const RunFigures& run);

// As `verdict` in summary.json.
nlohmann::ordered_json to_json(const Verdict& verdict);

// The table of rules as docs/verdict.md has it.
std::string rules_as_markdown();

}  // namespace tandem::launch
