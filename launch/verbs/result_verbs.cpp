#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "coordinator/run_folder/ps.hpp"
#include "coordinator/run_folder/registry.hpp"
#include "coordinator/scene/show.hpp"
#include "launch/verbs/options.hpp"
#include "launch/verbs/verbs.hpp"

namespace tandem::launch {

void add_movie(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("movie", "Make a film of the frames of a run");
  auto folder = std::make_shared<std::string>(), scene = std::make_shared<std::string>(),
       size = std::make_shared<std::string>("1280x720");
  auto options = std::make_shared<MovieOptions>();
  verb->add_option("run", *folder, "Folder of the run, its --out")->required();
  verb->add_option("-o,--output", options->out, "Film (MP4); without it RUN/movie.mp4");
  verb->add_option("--fps", options->frames_per_second, "Frames per second of the film")
      ->check(finite_in_range(0.1, 240.0))
      ->capture_default_str();
  verb->add_option("--size", *size, "Width and height [pixels]")->capture_default_str();
  verb->add_option("--colour-by", options->colour_by,
                   "What colours the spheres: speed, radius, spin, or one of output.fields of the scene")
      ->capture_default_str();
  verb->add_option("--scene", *scene, "Scene of the run; without it the copy in the folder of the run");
  verb->callback([=] {
    options->size = parse_picture_size(*size);
    movie(*folder, *scene, *options);
  });
}

void add_ps(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("ps", "List your runs on this host: those in progress and those that died");
  auto json = std::make_shared<bool>(false), forget = std::make_shared<bool>(false);
  auto status_of = std::make_shared<std::string>();
  verb->add_flag("--json", *json, "As JSON");
  verb->add_flag("--forget-died", *forget, "No longer list runs that died; their folders stay");
  verb->add_option("--status", *status_of, "Print the status of the run in this folder, and nothing else");
  verb->callback([=] {
    if (!status_of->empty()) {
      const std::string status = read_run(*status_of).status;
      if (status.empty())
        throw Error(ErrorCode::usage, "holds no run", *status_of, "give the --out folder of a run");
      fmt::print("{}\n", status);
      return;
    }
    if (*forget) fmt::print("{} forgotten\n", forget_died_runs());
    fmt::print("{}", *json ? list_of_runs_as_json() : list_of_runs());
  });
}

void add_stop(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "stop", "Stop a run after its window, as Ctrl-C does: results and restart files are kept");
  auto run = std::make_shared<std::string>();
  auto patience = std::make_shared<double>(60);  // [s]
  verb->add_option("run", *run, "Pid or folder of the run")->required();
  verb->add_option("--patience", *patience, "Longest wait for its end [s]")
      ->check(finite_in_range(0.0, 1e6))
      ->capture_default_str();
  verb->callback([=] { stop_run(*run, std::chrono::milliseconds(std::llround(1e3 * *patience))); });
}

}  // namespace tandem::launch
