#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "common/error.hpp"
#include "common/scene/columns.hpp"
#include "common/seconds.hpp"
#include "coordinator/run/describe.hpp"
#include "coordinator/run/dry_run.hpp"
#include "coordinator/run/run.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "coordinator/scene/show.hpp"
#include "launch/import/import.hpp"
#include "launch/verbs/options.hpp"
#include "launch/verbs/verbs.hpp"
#include "mbd_server/coupling/machine_modes.hpp"

namespace tandem::launch {
namespace {

// A stiffness; the check of the library would print the largest number there is.
std::string stiffness_fault(const std::string& text) {
  double value = 0;
  return CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0
             ? std::string()
             : "'" + shortened(text) + "' is not a finite number > 0";
}

std::string length_fault(const std::string& text) {
  double value = 0;
  return CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0
             ? std::string()
             : "'" + shortened(text) + "' is no finite length > 0 in metres";
}

// Options of the verbs that make a dry run.
struct Start {
  RunOptions options;
  double patience = 60;  // [s]
  bool files_only = false;

  SceneFile read(const std::string& path) const {
    return read_scene(path, options.overrides,
                      SettleOn{.backend = options.backend,
                               .settles = !files_only,
                               .fills = !options.sph_server.has_value(),
                               .picture = unsettled_picture(path)});
  }
  std::optional<DryRun> run(const SceneFile& file) {
    if (files_only) return {};
    options.patience = bounded_seconds(patience, least_patience, most_patience, "--patience");
    return dry_run(file, options);
  }
};

std::shared_ptr<Start> add_start(CLI::App& verb) {
  auto start = std::make_shared<Start>();
  verb.add_flag(
      "--files-only", start->files_only,
      "Look at the files only; without it the solvers are started as for a run, and leave before the first "
      "window");
  add_set(verb, start->options.overrides.set);
  add_servers(verb, start->options);
  verb.add_option("--backend", start->options.backend, "Where particles would be computed")
      ->check(CLI::IsMember({"auto", "cpu", "cuda"}))
      ->capture_default_str();
  verb.add_option("--patience", start->patience, "Longest wait for an answer of a server [s]")
      ->capture_default_str();
  return start;
}

}  // namespace

void add_validate(CLI::App& app, int& status) {
  CLI::App* verb = app.add_subcommand(
      "validate", "Check scenes, the files that they name, and whether a run of them starts");
  auto scenes = std::make_shared<std::vector<std::string>>();
  verb->add_option("scenes", *scenes, "Scene files")->required();
  const auto start = add_start(*verb);
  verb->callback([=, &status] {
    for (const std::string& path : *scenes) {
      std::string said;  // description of the scene, also of one that is refused
      try {
        const SceneFile file = start->read(path);
        said = remarks(file, nullptr, "  ");
        const std::optional<DryRun> started = start->run(file);
        said = remarks(file, started ? &*started : nullptr, "  ");
        const bool controlled = file.scene.mbd && !scene::control_inputs(*file.scene.mbd).empty();
        fmt::print("{}: ok{}\n", path,
                   controlled ? " with --controller PROGRAM, without which a run is refused" : "");
      } catch (const Error& error) {
        const bool named = std::string_view(error.what()).find(path) != std::string_view::npos;
        fmt::print(stderr, "error: {}{}\n", named ? "" : path + ": ", error.what());
        status = exit_status(error.code());
        if (error.code() == ErrorCode::interrupted) return;  // nor are the other scenes looked at
      }
      fmt::print("{}", said);
      std::fflush(stdout);
    }
  });
}

void add_describe(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("describe", "Show what a scene consists of");
  auto scene = std::make_shared<std::string>();
  verb->add_option("scene", *scene, "Scene file")->required();
  const auto start = add_start(*verb);
  verb->callback([=] {
    const SceneFile file = start->read(*scene);
    std::optional<DryRun> started;
    try {
      started = start->run(file);
    } catch (const Error&) {
      fmt::print("{}\n", describe(file, nullptr));
      std::fflush(stdout);
      throw;
    }
    fmt::print("{}", describe(file, started ? &*started : nullptr));
  });
}

void add_preview(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "preview", "Draw the start of a scene, with its extents and the names of bodies and joints");
  auto scene = std::make_shared<std::string>(), out = std::make_shared<std::string>();
  verb->add_option("scene", *scene, "Scene file")->required();
  verb->add_option("-o,--output", *out, "Picture (PNG); without it SCENE_preview.png, here");
  auto overrides = std::make_shared<Overrides>();
  add_set(*verb, overrides->set);
  auto unsettled = std::make_shared<bool>(false);
  verb->add_flag(
      "--unsettled", *unsettled,
      "Draw the spheres as they settle before the start, in the colours of their speeds, and say which "
      "do not come to rest; without -o SCENE_unsettled.png");
  verb->callback(
      [=] { *unsettled ? preview_unsettled(*scene, *out, *overrides) : preview(*scene, *out, *overrides); });
}

void add_modes(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("modes", "Show natural frequencies and damping of a scene's machine");
  auto scene = std::make_shared<std::string>();
  verb->add_option("scene", *scene, "Scene file")->required();
  auto as_given = std::make_shared<bool>(false);
  verb->add_flag(
      "--as-given", *as_given,
      "About the configuration and the rates of the scene, where the machine must stay; without it "
      "about the equilibrium near it");
  auto overrides = std::make_shared<Overrides>();
  add_set(*verb, overrides->set);
  verb->callback([=] {
    const SceneFile file = read_scene(*scene, *overrides);
    if (!file.scene.mbd)
      throw Error(ErrorCode::usage, "the scene has no machine", file.origin,
                  "give a scene with the part mbd");
    fmt::print("{}", mbd::machine_modes(file.scene, *as_given));
  });
}

void add_import(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("import", "Make a scene of a STEP or URDF model");
  auto options = std::make_shared<ImportOptions>();
  const auto add_list = [&](const char* name, std::vector<std::string>& values, const char* meaning) {
    return verb->add_option(name, values, meaning)->allow_extra_args(false);
  };
  verb->add_option("model", options->model, "STEP or URDF file")->required();
  CLI::Option* output = verb->add_option("-o,--output", options->output,
                                         "New scene file; of URDF, without it the scene is printed");
  verb->add_flag("--replace", options->replace, "Replace that file where it is there")->needs(output);
  CLI::Option* into = verb->add_option("--into", options->into,
                                       "Scene with particles that takes the bodies, joints and walls");
  CLI::Option* material = add_list(
      "--material", options->materials,
      "URDF: material of the walls, a name of the scene of --into. STEP: of the parts that a pattern "
      "matches, "
      "PATTERN=NAME, of that scene or of docs/materials.md, for their density; may be given several times");
  into->needs(material);
  verb->add_flag("--free-root", options->free_root, "URDF: the root link is free, not fixed to the ground");
  auto stops = std::make_shared<std::vector<double>>();
  verb->add_option(
          "--stops", *stops,
          "URDF: stiffness of the stops of joints with limits: of angles [N m/rad], of lengths [N/m]")
      ->expected(2)
      ->check(stiffness_fault);
  add_list("--density", options->densities, "STEP: density of parts, PATTERN=VALUE [kg/m3]");
  add_list("--merge", options->merge, "STEP: each assembly that the pattern matches becomes one body");
  add_list("--ground", options->ground, "STEP: bodies with a part that the pattern matches are fixed");
  verb->add_option("--fuse-smaller-than", options->fuse_smaller_than,
                   "STEP: parts with a shorter diagonal become part of the heaviest body that they touch [m]")
      ->check(length_fault);
  verb->add_option(
          "--deviation", options->deviation,
          "STEP: largest distance of mesh and surface [m]; without it 1/1000 of the diagonal of each part")
      ->check(length_fault);
  verb->add_flag("--joints", options->joints, "STEP: write the proposed joints into the scene");
  verb->add_option("--least-confidence", options->least_confidence, "STEP: of the joints that are written")
      ->check(finite_in_range(0.0, 1.0))
      ->capture_default_str();
  verb->callback([=] {
    if (!stops->empty()) options->stops = StopStiffness{stops->at(0), stops->at(1)};
    import_model(*options);
  });
}

}  // namespace tandem::launch
