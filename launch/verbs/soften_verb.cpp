// `tandem soften` is the Python module tandem.soften_command: this verb knows the options, and starts it in
// its place.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "launch/verbs/options.hpp"
#include "launch/verbs/python_module.hpp"
#include "launch/verbs/verbs.hpp"

namespace tandem::launch {
namespace {

struct SoftenWords {
  std::string scene, error, modulus, step, window, out, file, backend;
  std::vector<std::string> set, of;
  int starts = 3, most = 30, jobs = 1, threads = 0;
  double overlap = 0.5, limit = 0;  // [-], [s]
  bool retry = false;
};

std::vector<std::string> arguments(const SoftenWords& words) {
  std::vector<std::string> all{words.scene};
  const auto add = [&all](const char* name, const std::string& value) {
    if (!value.empty()) all.push_back(fmt::format("{}={}", name, value));
  };
  add("--error", words.error);
  for (const std::string& text : words.of) add("--of", text);
  for (const std::string& text : words.set) add("--set", text);
  add("--starts", std::to_string(words.starts));
  add("--most", std::to_string(words.most));
  add("--overlap", fmt::format("{}", words.overlap));
  add("--modulus", words.modulus);
  add("--step", words.step);
  add("--window", words.window);
  add("--jobs", std::to_string(words.jobs));
  if (words.threads > 0) add("--threads", std::to_string(words.threads));
  if (words.limit > 0) add("--limit", fmt::format("{}", words.limit));
  add("--out", words.out);
  if (!words.file.empty()) all.insert(all.end(), {"-o", words.file});
  add("--backend", words.backend);
  if (words.retry) all.emplace_back("--retry");
  return all;
}

void add_levels(CLI::App& verb, SoftenWords& words) {
  verb.add_option("--modulus", words.modulus,
                  "Numbers by which moduli are divided, as in 4,16,64; without it 2, 4, 8 to 1024");
  verb.add_option("--step", words.step,
                  "Micro steps as shares of the critical time, as in 0.2,0.4; without it from that of the "
                  "scene to 0.4");
  verb.add_option("--window", words.window,
                  "Coupling windows [s], as in 0.002,0.004; without it from that of the scene to the frame "
                  "interval");
}

void add_run_options(CLI::App& verb, SoftenWords& words) {
  verb.add_option("--jobs", words.jobs, "Runs side by side; with 1 their times are not disturbed")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  verb.add_option("--threads", words.threads, "Threads of each run, 0: the cores divided by the jobs")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  verb.add_option("--limit", words.limit, "Longest wall time of a run [s], 0: none")
      ->check(finite_in_range(0.0, 1e9))
      ->capture_default_str();
  verb.add_option("--backend", words.backend, "Where particles are computed")
      ->check(CLI::IsMember({"auto", "cpu", "cuda"}));
  verb.add_flag("--retry", words.retry, "Run settings that failed again");
}

}  // namespace

void add_soften(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "soften", "Find softer grains, longer micro steps and windows that keep a wanted error, for speed");
  auto words = std::make_shared<SoftenWords>();
  verb->add_option("scene", words->scene, "Scene file (JSON) with grains")->required();
  verb->add_option("--error", words->error, "Wanted error relative to the scene as it is: 1% or 0.01")
      ->required();
  verb->add_option("--of", words->of,
                   "Result that keeps the error: COLUMN as in hinge.q for its course, COLUMN:REDUCTION as in "
                   "mouth.flow:mean:0.4:0.7 or summary.KEY for a number; may be given several times")
      ->required()
      ->allow_extra_args(false);
  verb->add_option("--set", words->set, "NAME=VALUE: another value of a parameter of the scene")
      ->allow_extra_args(false);
  verb->add_option("--starts", words->starts,
                   "Random starts of each setting: their scatter is the least error that means anything")
      ->check(CLI::Range(1, 99))
      ->capture_default_str();
  verb->add_option("--overlap", words->overlap, "Largest overlap relative to the smaller radius")
      ->check(finite_in_range(1e-9, 1.0))
      ->capture_default_str();
  verb->add_option("--most", words->most, "Settings that are run at most")
      ->check(CLI::Range(2, 10000))
      ->capture_default_str();
  add_levels(*verb, *words);
  verb->add_option("--out", words->out,
                   "Folder of the runs; without it out/soften_NAME. A second call continues where the first "
                   "stopped");
  verb->add_option("-o", words->file, "File of the softened scene; without it NAME_soft.json in the folder");
  add_run_options(*verb, *words);
  verb->callback([=] { become_python("tandem.soften_command", arguments(*words)); });
}

}  // namespace tandem::launch
