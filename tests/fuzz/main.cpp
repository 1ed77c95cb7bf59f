// tandem_fuzz: damaged inputs for every part of tandem that reads bytes from outside (docs/fuzzing.md).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>

#include "common/error.hpp"
#include "common/log.hpp"
#include "tests/fuzz/runner.hpp"

#ifdef TANDEM_SANITIZED
// Leaks of third-party libraries.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libassimp\nleak:liburdfdom_model\n";
}
#endif

int main(int argc, char** argv) {
  using namespace tandem;
  CLI::App app(
      "Gives damaged inputs to a part of tandem. Exit status 1: an input made it crash, hang, take too much "
      "memory or "
      "accept damage; that input is saved in the working folder.");
  std::vector<std::string> names{"all"};
  for (const fuzz::TargetKind& kind : fuzz::all_targets()) names.emplace_back(kind.name);
  std::string name, file;
  fuzz::Plan plan;
  app.add_option("TARGET", name, "the part that reads the inputs; all: one target after the other")
      ->required()
      ->check(CLI::IsMember(names));
  const auto* count = app.add_option("--count", plan.count, "number of inputs");
  const auto* seconds =
      app.add_option("--seconds", plan.seconds, "time limit [s]")->check(CLI::PositiveNumber);
  app.add_option("--seed", plan.seed, "start of the random numbers: one seed always gives the same inputs")
      ->capture_default_str();
  app.add_option("--jobs", plan.jobs, "number of processes")
      ->check(CLI::Range(1u, 1024u))
      ->capture_default_str();
  const auto* input = app.add_option("--input", file, "give the target the input in this file");
  CLI11_PARSE(app, argc, argv);
  if (!*count && !*seconds && !*input) {
    fmt::print(stderr, "tandem_fuzz: give --count, --seconds or --input\n");
    return exit_status(ErrorCode::usage);
  }
  if (!*count) plan.count = std::numeric_limits<std::uint64_t>::max() - plan.jobs;
  log::setup("tandem_fuzz", "off");
  const auto kinds = fuzz::all_targets();
  int status = 0;
  try {
    for (const fuzz::TargetKind& kind : kinds)
      if (name == "all" || name == kind.name)
        status = std::max(status, *input ? fuzz::run_file(kind, file) : fuzz::run_plan(kind, plan));
    return status;
  } catch (const Error& error) {
    fmt::print(stderr, "tandem_fuzz: {}\n", error.what());
    return exit_status(error.code());
  }
}
