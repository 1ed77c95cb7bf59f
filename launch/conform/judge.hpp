// Runs the checks on one participant.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "launch/conform/check.hpp"

namespace tandem::conform {

enum class Outcome { passed, failed, refused, not_claimed };
const char* name(Outcome outcome);  // "PASS", "FAIL", "refused", "not claimed"

struct Result {
  const Check* check = nullptr;
  Outcome outcome{};
  std::vector<Finding> findings;
  std::string scene;     // on which it was judged
  std::string sentence;  // why it failed, or was refused
  double seconds = 0;
  bool accepted = false;  // the participant took the scene
  // The finding that is farthest from its expectation, relative to its tolerance; none: the check compares
  // no numbers.
  const Finding* worst() const;
};

struct Judgement {
  protocol::Role role{};
  std::string program;  // as the participant calls itself
  std::uint64_t capabilities = 0;
  std::vector<Result> results;

  std::size_t count(Outcome outcome) const;
  // Each check passed, was refused with its scene, or is about a capability that is not claimed; and at
  // least one scene was accepted.
  bool passed() const;
  bool accepted() const;  // it took at least one scene
  // Names of the failed checks.
  std::vector<std::string> failed() const;
};

// Judges on the built-in scenes, or on `scene` only, by the checks that hold on any. `wanted`: names of the
// checks; empty: all. `report` gets each result at once.
Judgement judge(Subject& subject, const Limits& limits, const std::optional<JudgedScene>& scene = {},
                const std::vector<std::string>& wanted = {},
                const std::function<void(const Result&)>& report = {});

}  // namespace tandem::conform
