// `tandem sweep` is the Python module tandem.sweep_command: this verb knows the options, and starts it in its
// place.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "launch/verbs/options.hpp"
#include "launch/verbs/python_module.hpp"
#include "launch/verbs/verbs.hpp"

namespace tandem::launch {
namespace {

struct SweepWords {
  std::string scene, out, share, backend;
  std::vector<std::string> set, of;
  int jobs = 1, threads = 0;
  double limit = 0;  // [s]
  bool retry = false;
};

std::vector<std::string> arguments(const SweepWords& words) {
  std::vector<std::string> all{words.scene};
  const auto add = [&all](const char* name, const std::string& value) {
    if (!value.empty()) all.push_back(fmt::format("{}={}", name, value));
  };
  for (const std::string& text : words.set) add("--set", text);
  for (const std::string& text : words.of) add("--of", text);
  add("--jobs", std::to_string(words.jobs));
  if (words.threads > 0) add("--threads", std::to_string(words.threads));
  if (words.limit > 0) add("--limit", std::to_string(words.limit));
  add("--out", words.out);
  add("--backend", words.backend);
  add("--share", words.share);
  if (words.retry) all.emplace_back("--retry");
  return all;
}

}  // namespace

void add_sweep(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "sweep", "Run a scene for several values of its parameters, and compare results of the runs");
  auto words = std::make_shared<SweepWords>();
  verb->add_option("scene", words->scene, "Scene file (JSON) with parameters")->required();
  verb->add_option(
          "--set", words->set,
          "Values of a parameter, in its unit: NAME=FIRST:LAST:COUNT or NAME=VALUE,VALUE; of several "
          "parameters all combinations are run")
      ->required()
      ->allow_extra_args(false);
  verb->add_option("--of", words->of,
                   "Result to compare: COLUMN:REDUCTION as in mouth.flow:mean, with a range of time "
                   "mouth.flow:mean:0.4:0.7, or summary.KEY; may be given several times")
      ->allow_extra_args(false);
  verb->add_option("--out", words->out,
                   "Folder of the results; without it out/sweep_NAME. A second call continues where the "
                   "first stopped");
  verb->add_option("--jobs", words->jobs, "Runs side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  verb->add_option("--threads", words->threads, "Threads of each run, 0: the cores divided by the jobs")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  verb->add_option("--limit", words->limit, "Longest wall time of a run [s], 0: none")
      ->check(finite_in_range(0.0, 1e9))
      ->capture_default_str();
  verb->add_option("--backend", words->backend, "Where particles are computed")
      ->check(CLI::IsMember({"auto", "cpu", "cuda"}));
  verb->add_option("--share", words->share,
                   "PART/PARTS: only this part of the variants, as a task of an array job; a call without it "
                   "collects all");
  verb->add_flag("--retry", words->retry, "Run variants that failed again");
  verb->callback([=] { become_python("tandem.sweep_command", arguments(*words)); });
}

}  // namespace tandem::launch
