#include "launch/conform/judge.hpp"

#include <algorithm>
#include <chrono>

#include "common/error.hpp"
#include "launch/conform/scenes.hpp"

namespace tandem::conform {
namespace {

double excess(const Finding& finding) {
  if (finding.tolerance > 0) return finding.deviation / finding.tolerance;
  return finding.deviation > 0 || finding.deviation != finding.deviation ? 1e300 : 0;
}

void judge_one(Subject& subject, const JudgedScene& scene, const Limits& limits, Result& result) {
  Examination examination(subject, scene, limits);
  result.outcome = Outcome::failed;
  result.sentence.clear();
  try {
    result.check->run(examination);
    const bool agree = std::ranges::all_of(examination.findings(), &Finding::passed);
    if (agree && examination.complaint().empty()) result.outcome = Outcome::passed;
    result.sentence = examination.complaint();
  } catch (const SceneRefused& error) {
    result.outcome = Outcome::refused;
    result.sentence = error.what();
  } catch (const Error& error) {
    result.sentence = error.what();
    // Why it has ended, in its own words.
    const std::string words = error.code() == ErrorCode::peer_lost ? subject.last_words() : "";
    if (!words.empty()) result.sentence += "; its last line: " + words;
  } catch (const std::exception& error) {
    result.sentence = error.what();
  }
  result.findings = examination.findings();
  result.accepted = examination.accepted();
}

void judge_on_built_in(Subject& subject, const Limits& given, Result& result) {
  const BuiltInScene& scene = built_in_scene(result.scene);
  std::string text = scene.text;
  Limits limits = given;
  if (result.check->is_long) {
    if (limits.long_run == 0) limits.long_run = shortest_long_run;
    text = with_end_time(text, limits.long_run);
  }
  judge_one(subject, judged_scene(text, result.scene), limits, result);
  if (result.outcome != Outcome::refused || subject.role() != protocol::Role::dem) return;
  result.scene += " with hooke";
  judge_one(subject, judged_scene(with_simplest_contact(text), result.scene), limits, result);
}

}  // namespace

const char* name(Outcome outcome) {
  switch (outcome) {
    case Outcome::passed:
      return "PASS";
    case Outcome::failed:
      return "FAIL";
    case Outcome::refused:
      return "refused";
    case Outcome::not_claimed:
      return "not claimed";
  }
  return "";
}

const Finding* Result::worst() const {
  const auto found = std::ranges::max_element(findings, {}, excess);
  return found == findings.end() ? nullptr : &*found;
}

std::size_t Judgement::count(Outcome outcome) const {
  return static_cast<std::size_t>(std::ranges::count(results, outcome, &Result::outcome));
}

bool Judgement::accepted() const {
  return std::ranges::any_of(results, &Result::accepted);
}

bool Judgement::passed() const {
  return count(Outcome::failed) == 0 && accepted();
}

std::vector<std::string> Judgement::failed() const {
  std::vector<std::string> names;
  for (const Result& result : results)
    if (result.outcome == Outcome::failed) names.emplace_back(result.check->name);
  return names;
}

Judgement judge(Subject& subject, const Limits& limits, const std::optional<JudgedScene>& scene,
                const std::vector<std::string>& wanted, const std::function<void(const Result&)>& report) {
  Judgement judgement;
  judgement.role = subject.role();
  // Nothing can be judged of a participant that does not register: its only result is the check `hello`.
  bool registers = true;
  try {
    const protocol::Hello hello = greet(subject, limits);
    judgement.program = hello.program;
    judgement.capabilities = hello.capabilities;
  } catch (const Error&) {
    registers = false;
  }
  for (const Check& check : checks()) {
    if (check.is_long && limits.long_run == 0 && wanted.empty()) continue;
    if (!check.of(judgement.role) || (scene && !check.any_scene)) continue;
    if (!registers && std::string_view(check.name) != "hello") continue;
    if (registers && !wanted.empty() && std::ranges::find(wanted, check.name) == wanted.end()) continue;
    Result result;
    result.check = &check;
    result.scene = scene ? scene->configuration.origin : check.scene(judgement.role);
    const auto begin = std::chrono::steady_clock::now();
    if ((check.needs & ~judgement.capabilities) != 0)
      result.outcome = Outcome::not_claimed;
    else if (scene)
      judge_one(subject, *scene, limits, result);
    else
      judge_on_built_in(subject, limits, result);
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (report) report(result);
    judgement.results.push_back(std::move(result));
  }
  return judgement;
}

}  // namespace tandem::conform
