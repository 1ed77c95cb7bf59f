// `tandem plan`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "common/error.hpp"
#include "launch/sizing/plan.hpp"
#include "launch/verbs/options.hpp"
#include "launch/verbs/verbs.hpp"

namespace tandem::launch {
namespace {

struct PlanWords {
  std::string scene;
  std::map<std::string, double> set;
  int gpus = 0, ranks = 0;
  double spheres = 0, memory_GB = 0;
};

PlanRequest request_of(const PlanWords& words) {
  if ((words.gpus > 0) == (words.ranks > 0))
    throw Error(ErrorCode::usage,
                words.gpus > 0 ? "both --gpus and --ranks are given" : "neither --gpus nor --ranks is given",
                "plan", "give one of them: --gpus 4 for cards, --ranks 4 for cores of one host");
  PlanRequest request;
  request.gpus = words.gpus > 0;
  request.count = static_cast<unsigned>(request.gpus ? words.gpus : words.ranks);
  request.spheres = words.spheres;
  request.memory = 1e9 * words.memory_GB;
  return request;
}

}  // namespace

void add_plan(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "plan", "Predict memory and time of a bed on several GPUs or ranks, and what limits");
  auto words = std::make_shared<PlanWords>();
  verb->add_option("scene", words->scene, "Scene file with grains")->required();
  verb->add_option("--gpus", words->gpus, "Number of GPUs, eight to a host")->check(CLI::Range(1, 65536));
  verb->add_option("--ranks", words->ranks, "Number of ranks on the cores of one host, one core each")
      ->check(CLI::Range(1, 4096));
  verb->add_option("--spheres", words->spheres,
                   "Number of spheres in a bed like that of the scene; without it, those of the scene")
      ->check(finite_in_range(1, 1e12));
  verb->add_option("--memory", words->memory_GB,
                   "Memory of a GPU, or of the host of the ranks [GB]; without it 80, or that of this host")
      ->check(finite_in_range(0.001, 1e6));
  add_set(*verb, words->set);
  verb->callback([words] {
    const PlanRequest request = request_of(*words);
    Overrides overrides;
    overrides.set = words->set;
    fmt::print("{}", plan(read_scene(words->scene, overrides, SettleOn{.settles = false}), request));
  });
}

}  // namespace tandem::launch
