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
  return "leak:libassimp\n";
}
#endif

int main(int argc, char** argv) {
  using namespace tandem;
  CLI::App app(
      "Has one target take damaged inputs. Exit status 1: one of them did what must not happen; it is "
      "saved.");
  std::vector<std::string> names{"all"};
  for (const fuzz::TargetKind& kind : fuzz::all_targets()) names.emplace_back(kind.name);
  std::string name, file;
  fuzz::Plan plan;
  app.add_option("TARGET", name, "what takes the inputs; all: one target after the other")
      ->required()
      ->check(CLI::IsMember(names));
  const auto* count = app.add_option("--count", plan.count, "how many inputs");
  const auto* seconds = app.add_option("--seconds", plan.seconds, "how long")->check(CLI::PositiveNumber);
  app.add_option("--seed", plan.seed, "other inputs for each; the same ones for the same")
      ->capture_default_str();
  app.add_option("--jobs", plan.jobs, "processes")->check(CLI::Range(1u, 1024u))->capture_default_str();
  const auto* input = app.add_option("--input", file, "take this one input, from a file");
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
