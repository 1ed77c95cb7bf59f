// Evaluates the checks of a scene on the signals and the summary of a run.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "common/scene/model.hpp"
#include "coordinator/results/signals.hpp"

namespace tandem::launch {

struct CheckResult {
  scene::Check check;
  double value = 0;
  double error = 0;  // relative to |expected|, or absolute
  bool passed = false;
};

// Throws Error{scene} for a signal that does not exist, or an empty time range.
// `signals`: the files in which the signals are.
std::vector<CheckResult> evaluate(const std::vector<scene::Check>& checks,
                                  const std::vector<const Signals*>& signals, const nlohmann::json& summary);

}  // namespace tandem::launch
