// The `tandem` command: verbs and their options, nothing else.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/parse.hpp"
#include "common/seconds.hpp"
#include "common/stack_limit.hpp"
#include "common/utf8.hpp"
#include "launch/build_info.hpp"
#include "launch/conform/conform.hpp"
#include "launch/coordinator/checkpoint.hpp"
#include "launch/coordinator/describe.hpp"
#include "launch/coordinator/dry_run.hpp"
#include "launch/coordinator/machine_modes.hpp"
#include "launch/coordinator/run.hpp"
#include "launch/coordinator/scene_file.hpp"
#include "launch/coordinator/show.hpp"
#include "launch/import/import.hpp"
#include "launch/keys/keys.hpp"
#include "launch/new_project/new_project.hpp"
#include "launch/replay/replay.hpp"
#include "launch/run_folder/ps.hpp"
#include "launch/run_folder/registry.hpp"
#include "launch/study/study.hpp"
#include "protocol/version.hpp"

namespace {

using namespace tandem;
using namespace tandem::launch;

// Turns a word into the value that it names. A word that is none of them is refused with the nearest one.
template <class Value>
CLI::Validator one_of(const std::map<std::string, Value>& words) {
  std::vector<std::string> names;
  for (const auto& item : words) names.push_back(item.first);
  return CLI::Validator(
      [words, names](std::string& word) -> std::string {
        const auto found = words.find(word);
        if (found == words.end())
          return fmt::format("there is no '{}' ({})", printable(shortened(word)),
                             suggest_name(word, names, "words"));
        word = std::to_string(static_cast<int>(found->second));
        return {};
      },
      fmt::format("{{{}}}", fmt::join(names, ",")));
}

std::string version_text() {
  return fmt::format("tandem {}, protocol {}.{}\nback ends: cpu{}\ntransports: shm, inproc, stream{}",
                     version, protocol::protocol_version.major, protocol::protocol_version.minor,
                     has_cuda ? ", cuda" : "", has_dds ? ", dds" : "");
}

constexpr std::size_t longest_run_name = 128;  // as protocol/dds/dds_channel.cpp has it; less over shm

// JSON, into which the value goes, has no other numbers.
void expect_finite(const std::optional<double>& seconds, const char* option) {
  if (seconds && !std::isfinite(*seconds))
    throw Error(ErrorCode::usage, fmt::format("{} is no time that a run can have", *seconds), option,
                "give a finite number of seconds");
}

// A stiffness; the check of the library would print the largest number there is.
std::string stiffness_fault(const std::string& text) {
  double value = 0;
  return CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0
             ? std::string()
             : "'" + shortened(text) + "' is no finite number > 0";
}

// Options that replace the servers of a run.
template <class Options>
void add_servers(CLI::App& verb, Options& options) {
  verb.add_option(
      "--mbd-server", options.mbd_server,
      "Command of a multibody solver that replaces mbd_server (docs/swap.md), with its arguments");
  verb.add_option("--dem-server", options.dem_server, "The same for the particle solver, dem_server");
  verb.add_option("--sph-server", options.sph_server, "The same for the solver of a liquid, sph_server");
  verb.add_flag("--allow-scene-servers", options.allow_scene_servers,
                "Start the programs that the scene names as mbd.server, dem.server and sph.server: only for "
                "scenes that you trust");
}

void add_run(CLI::App& app, int& status) {
  CLI::App* verb = app.add_subcommand("run", "Run a scene and leave its results in a folder");
  auto options = std::make_shared<RunOptions>();
  auto patience = std::make_shared<double>(60);            // [s]
  auto lease = std::make_shared<std::optional<double>>();  // [s]
  auto every = std::make_shared<std::optional<double>>();  // [s]
  auto no_picture = std::make_shared<bool>(false), no_report = std::make_shared<bool>(false);
  auto estimate = std::make_shared<std::string>("default");
  const std::map<std::string, Transport> transports{{"shm", Transport::shm},
                                                    {"inproc", Transport::inproc},
                                                    {"dds", Transport::dds},
                                                    {"stream", Transport::stream}};

  verb->add_option("scene", options->scene, "Scene file (JSON)")->required();
  verb->add_option("--out", options->folder, "Folder of the results")->required();
  verb->add_option("--backend", options->backend, "Where particles are computed")
      ->check(CLI::IsMember({"auto", "cpu", "cuda"}))
      ->capture_default_str();
  verb->add_option("--threads", options->threads,
                   "Threads of the particle solver on the CPU, 0: all cores; from 4 on a quarter of them, "
                   "and at least 2, are left to the other programs")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  verb->add_option(
          "--transport", options->transport,
          "How the servers are reached: shm, inproc, dds, or stream, their standard input and output")
      ->transform(one_of(transports))
      ->default_str("shm");
  verb->add_option("--end-time", options->overrides.end_time, "Replaces the scene's end_time [s]");
  verb->add_option("--scheme", options->overrides.scheme, "Replaces the scene's coupling.scheme");
  verb->add_option("--window", options->overrides.window, "Replaces the scene's coupling.window [s]");
  verb->add_flag("--equilibrium", options->overrides.equilibrium,
                 "The machine starts in the static equilibrium near the configuration of the scene");
  CLI::Option* attach =
      verb->add_flag("--attach", options->attach, "Servers are started by hand; prints the commands to type");
  verb->add_option("--run", options->run_name, "Name that attached servers are started with")->needs(attach);
  verb->add_option("--dds-interface", options->dds_interface, "Network interface of transport dds")
      ->capture_default_str();
  verb->add_option("--dds-peer", options->dds_peer, "Address of the other host of transport dds");
  CLI::Option* secret = verb->add_option("--secret-file", options->secret_file,
                                         "File with the secret of a run of transport dds, which only its "
                                         "owner may read, the same for all programs of the "
                                         "run; without it TANDEM_SECRET of the environment counts. Servers "
                                         "that are started from here get one by themselves");
  CLI::Option* certificates = verb->add_option("--certificates", options->certificates,
                                               "Folder of certificates for transport dds that tandem keys "
                                               "has made, the same for all programs of the run: only "
                                               "they take part, and all is encrypted");
  verb->add_flag("--insecure", options->insecure,
                 "Transport dds without a secret: whoever reaches the network may read and change the run")
      ->excludes(secret)
      ->excludes(certificates);
  verb->add_option("--patience", *patience, "Longest wait for an answer of a server [s]")
      ->capture_default_str();
  verb->add_option(
      "--lease", *lease,
      "A program of the run that gives no sign of life for so long is lost [s]; 5 over shared memory, "
      "0.4 over dds. Longer ones let a run survive programs that are suspended");
  add_servers(*verb, *options);
  verb->add_option(
      "--controller", options->controller,
      "Command of a program that reads sensors and gives control inputs, a JSON line each per window");
  verb->add_option(
      "--checkpoint-every", *every,
      "Write restart files to OUT/checkpoint after this simulated time, again and again [s]; also at the "
      "end and on Ctrl-C");
  verb->add_option("--restart", options->restart,
                   "Go on from the restart files of an earlier run: its --out folder");
  verb->add_option("--record", options->record,
                   "File that takes all frames between the programs; an earlier recording is replaced, "
                   "any other file refused");
  verb->add_option(
          "--estimate", *estimate,
          "How the error that the multibody step leaves is measured: default, by the solver itself with at "
          "most a "
          "tenth of the steps, where it can; or richardson, by a second run of the whole scene with steps "
          "half as long, which takes two to three times the time in all")
      ->capture_default_str();
  verb->add_flag("--strict", options->strict,
                 "Exit status 1 where the verdict is suspect (docs/verdict.md), as where a check fails");
  verb->add_flag("--no-picture", *no_picture, "Do not render the last frame");
  verb->add_flag("--no-report", *no_report, "Do not write report.html");
  verb->add_flag("--quiet", options->quiet, "Only warnings and errors");
  verb->callback([=, &status] {
    const bool guarded = options->insecure || !options->secret_file.empty() || !options->certificates.empty();
    if (guarded && options->transport != Transport::dds)
      throw Error(ErrorCode::usage, "are for --transport dds", "--secret-file, --certificates and --insecure",
                  "leave them out: over shared memory only programs of this user take part");
    if (options->attach && options->transport == Transport::stream)
      throw Error(ErrorCode::usage, "is for servers that are started from here", "--transport stream",
                  "leave --attach out, or use shm or dds");
    options->patience = bounded_seconds(*patience, least_patience, most_patience, "--patience");
    if (*lease) options->lease = bounded_seconds(**lease, least_lease, most_lease, "--lease");
    if (*every) checkpoint_interval(options->checkpoint_every = **every);
    expect_finite(options->overrides.end_time, "--end-time");
    expect_finite(options->overrides.window, "--window");
    if (options->run_name.size() > longest_run_name)
      throw Error(ErrorCode::usage, "'" + shortened(options->run_name) + "' is no name for a run", "--run",
                  fmt::format("use 1 to {} letters, digits, '-', '_' and '.'", longest_run_name));
    options->estimate = parse_estimate(*estimate);
    options->picture = !*no_picture;
    options->report = !*no_report;
    status = run(*options);
  });
}

// Options of the verbs that make a dry run.
struct Start {
  RunOptions options;
  double patience = 60;  // [s]
  bool files_only = false;

  SceneFile read(const std::string& path) const {
    return read_scene(path, {}, SettleOn{.backend = options.backend, .settles = !files_only});
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
  add_servers(verb, start->options);
  verb.add_option("--backend", start->options.backend, "Where particles would be computed")
      ->check(CLI::IsMember({"auto", "cpu", "cuda"}))
      ->capture_default_str();
  verb.add_option("--patience", start->patience, "Longest wait for an answer of a server [s]")
      ->capture_default_str();
  return start;
}

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
        fmt::print("{}: ok\n", path);
      } catch (const Error& error) {
        const bool named = std::string_view(error.what()).find(path) != std::string_view::npos;
        fmt::print(stderr, "error: {}{}\n", named ? "" : path + ": ", error.what());
        status = exit_status(error.code());
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
  verb->callback([=] { preview(*scene, *out); });
}

void add_movie(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("movie", "Make a film of the frames of a run");
  auto folder = std::make_shared<std::string>(), scene = std::make_shared<std::string>(),
       size = std::make_shared<std::string>("1280x720");
  auto options = std::make_shared<MovieOptions>();
  verb->add_option("run", *folder, "Folder of the run, its --out")->required();
  verb->add_option("-o,--output", options->out, "Film (MP4); without it RUN/movie.mp4");
  verb->add_option("--fps", options->frames_per_second, "Frames per second of the film")
      ->check(CLI::Range(0.1, 240.0))
      ->capture_default_str();
  verb->add_option("--size", *size, "Width and height [pixels]")->capture_default_str();
  verb->add_option("--colour-by", options->colour_by,
                   "What colours the spheres: speed, radius, spin, or one of output.fields of the scene")
      ->capture_default_str();
  verb->add_option("--scene", *scene, "Scene of the run, where it is no longer where it was");
  verb->callback([=] {
    options->size = parse_picture_size(*size);
    movie(*folder, *scene, *options);
  });
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
  verb->callback([=] { fmt::print("{}", machine_modes(read_scene(*scene), *as_given)); });
}

void add_study(CLI::App& app, int& status) {
  CLI::App* verb =
      app.add_subcommand("study", "Sweep settings of a scene and measure error against run time");
  auto options = std::make_shared<StudyOptions>();
  verb->add_option("study", options->file, "Study file (JSON)")->required();
  verb->add_option("--out", options->folder,
                   "Folder of the results; a second call continues where the first stopped")
      ->required();
  add_servers(*verb, *options);
  verb->add_option("--jobs", options->jobs, "Runs side by side, 0: as many as the cores carry")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  verb->add_option("--want", options->want,
                   "Print the cheapest setting with at most this error: position=1e-3");
  verb->callback([=, &status] { status = study(*options); });
}

void add_import(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("import", "Make a scene of a URDF model");
  auto options = std::make_shared<ImportOptions>();
  verb->add_option("model", options->model, "URDF file")->required();
  verb->add_option("-o,--output", options->output, "Scene file; without it the scene is printed");
  CLI::Option* into = verb->add_option("--into", options->into,
                                       "Scene with particles that takes the bodies, joints and walls");
  CLI::Option* material = verb->add_option("--material", options->material,
                                           "Material of the walls, a name of the scene of --into");
  into->needs(material);
  material->needs(into);
  verb->add_flag("--free-root", options->free_root, "The root link is free, not fixed to the ground");
  auto stops = std::make_shared<std::vector<double>>();
  verb->add_option("--stops", *stops,
                   "Stiffness of the stops of joints with limits: of angles [N m/rad], of lengths [N/m]")
      ->expected(2)
      ->check(stiffness_fault);
  verb->callback([=] {
    if (!stops->empty()) options->stops = StopStiffness{stops->at(0), stops->at(1)};
    import_model(*options);
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
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  verb->callback([=] { stop_run(*run, std::chrono::milliseconds(std::llround(1e3 * *patience))); });
}

// Throws Error{usage} for bytes that are not UTF-8: summary, log and messages could not contain them.
void expect_utf8(const std::vector<std::string>& words) {
  for (const std::string& word : words)
    if (!is_utf8(word))
      throw Error(ErrorCode::usage, "is not UTF-8: \"" + printable(shortened(word)) + "\"", "command line",
                  "rename the file, or write the word in UTF-8");
}

void add_keys(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("keys", "Make what protects runs over a network (docs/security.md)");
  auto secret = std::make_shared<std::string>(), certificates = std::make_shared<std::string>();
  auto days = std::make_shared<int>(365);
  verb->add_option("--secret", *secret, "New file with a new secret")->type_name("FILE");
  CLI::Option* folder =
      verb->add_option("--certificates", *certificates, "New folder with new certificates")->type_name("DIR");
  verb->add_option("--days", *days, "How long the certificates are valid")
      ->check(CLI::Range(1, 3650))
      ->needs(folder)
      ->capture_default_str();
  verb->require_option(1, 3);
  verb->callback([=] {
    if (!secret->empty()) write_secret(*secret);
    if (!certificates->empty()) write_certificates(*certificates, *days);
  });
}

std::map<std::string, protocol::Role> all_roles() {
  std::map<std::string, protocol::Role> roles;
  for (const protocol::Role role : protocol::all_roles) roles[protocol::word_of(role)] = role;
  return roles;
}

void add_conform(CLI::App& app, int& status) {
  CLI::App* verb = app.add_subcommand(
      "conform", "Try whether a participant does what it claims, and name what it does otherwise");
  auto options = std::make_shared<conform::ConformOptions>();
  auto patience = std::make_shared<double>(10), answer = std::make_shared<double>(1);  // [s]
  auto list = std::make_shared<bool>(false);
  auto long_run = std::make_shared<double>(0);  // [s]
  const std::map<std::string, protocol::Role> roles = all_roles();
  const std::map<std::string, conform::Transport> transports{{"shm", conform::Transport::shm},
                                                             {"stream", conform::Transport::stream}};
  CLI::Option* command =
      verb->add_option("command", options->command,
                       "Program with its arguments, in one word; mbd_server, dem_server and sph_server are "
                       "those of this build");
  verb->add_option("--role", options->role, "Side that it takes")->required()->transform(one_of(roles));
  verb->add_option("--transport", options->transport, "How it is reached")
      ->transform(one_of(transports))
      ->default_str("shm");
  verb->add_option("--scene", options->scene,
                   "Judge on this scene, by the checks that hold on any, in place of the built-in ones")
      ->type_name("FILE");
  verb->add_option("--check", options->checks, "Only this check; may be given more than once")
      ->type_name("NAME")
      ->allow_extra_args(false);
  verb->add_option("--out", options->out, "Folder for conform.json, conform.html and participant.log")
      ->type_name("DIR");
  verb->add_option("--patience", *patience, "Longest wait for an answer [s]")->capture_default_str();
  verb->add_option("--answer-limit", *answer, "Longest answer to a window of 1 ms that counts as in time [s]")
      ->capture_default_str();
  verb->add_option("--long", *long_run, "Also try a run of this simulated time, 2 s or more [s]");
  verb->add_flag("--list", *list, "List the checks of the role, and judge nothing");
  verb->callback([=, &status] {
    if (*list) {
      fmt::print("{}", conform::list_of_checks(options->role));
      return;
    }
    if (command->empty())
      throw Error(ErrorCode::usage, "no participant is given", "tandem conform",
                  "give the command that starts it, as in tandem conform ./my_solver --role mbd");
    options->limits.patience = bounded_seconds(*patience, least_patience, most_patience, "--patience");
    options->limits.answer = bounded_seconds(*answer, least_patience, most_patience, "--answer-limit");
    if (*long_run != 0 && !(*long_run >= conform::shortest_long_run && *long_run <= 1e5))
      throw Error(ErrorCode::usage, fmt::format("{:g} s is no time of a long run", *long_run), "--long",
                  "give 2 to 100000 s of simulated time");
    options->limits.long_run = *long_run;
    status = conform::conform(*options);
  });
}

void add_replay(CLI::App& app, int& status) {
  CLI::App* verb = app.add_subcommand(
      "replay", "Repeat a recording against one solver, up to the first difference (docs/replay.md)");
  auto options = std::make_shared<ReplayOptions>();
  auto list = std::make_shared<bool>(false);
  auto patience = std::make_shared<double>(60);  // [s]
  const std::map<std::string, protocol::Role> roles = all_roles();
  verb->add_option("recording", options->recording,
                   "File of tandem run --record, or last_windows.rec of a failed run")
      ->required();
  CLI::Option* role = verb->add_option("--role", options->role, "Whose answers are compared: mbd, dem or sph")
                          ->transform(one_of(roles));
  verb->add_option("--server", options->server,
                   "Command of the server that is compared, with its arguments; without it the solver of "
                   "tandem, in this process")
      ->needs(role);
  const std::map<std::string, bool> transports{{"shm", false}, {"stream", true}};
  verb->add_option("--transport", options->stream,
                   "How that server is reached: shm, or stream, its standard input and output")
      ->transform(one_of(transports))
      ->default_str("shm")
      ->needs(role);
  verb->add_option("--patience", *patience, "Longest wait for an answer [s]")->capture_default_str();
  verb->add_flag("--list", *list, "Print a line for each frame, and replay nothing")->excludes(role);
  verb->callback([=, &status] {
    if (*list) return list_recording(options->recording);
    if (role->empty())
      throw Error(ErrorCode::usage, "needs --role mbd, --role dem, --role sph or --list", "tandem replay",
                  "--role names the solver whose answers are compared");
    options->patience = bounded_seconds(*patience, least_patience, most_patience, "--patience");
    status = replay(*options);
  });
}

void add_new(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("new", "Make a project with a solver of your own (docs/participant.md)");
  auto kind = std::make_shared<std::string>();
  auto wanted = std::make_shared<NewParticipant>();
  verb->add_option("kind", *kind, "What to make: participant")->required();
  verb->add_option("name", wanted->name, "Name of the project and of its program")->required();
  verb->add_option("--language", wanted->language, "Language of the solver: cpp, c, fortran")->required();
  verb->add_option("--role", wanted->role, "Solver of the bodies (mbd) or of the particles (dem)")
      ->required()
      ->check(CLI::IsMember({"mbd", "dem"}));
  verb->add_option("--out", wanted->folder, "New folder; without it one with the name, here")
      ->type_name("DIR");
  verb->callback([=] {
    if (*kind != "participant")
      throw Error(ErrorCode::usage, "makes no '" + shortened(*kind) + "'", "tandem new",
                  "write tandem new participant NAME");
    new_participant(*wanted);
  });
}

// Names of all verbs, and the long options of one.
std::vector<std::string> verbs_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

std::vector<std::string> options_of(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

// Throws Error{usage} with the unknown verb or option and the nearest one; the parser would name neither.
void expect_known_words(const CLI::App& app, const std::vector<std::string>& words) {
  const std::vector<std::string> verbs = verbs_of(app);
  const auto knows = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (words.empty())
    throw Error(ErrorCode::usage, "no verb is given", {},
                suggest_name("", verbs, "verbs") + "; tandem --help says more");
  if (words.front().starts_with('-')) return;
  if (!knows(verbs, words.front()))
    throw Error(ErrorCode::usage, "tandem has no verb '" + shortened(words.front()) + "'", {},
                suggest_name(words.front(), verbs, "verbs"));
  const std::vector<std::string> options = options_of(*app.get_subcommand(words.front()));
  for (const std::string& word : words) {
    if (word == "--") return;
    const std::string option = word.substr(0, word.find('='));
    if (option.starts_with("--") && !knows(options, option))
      throw Error(ErrorCode::usage, "tandem " + words.front() + " has no option '" + shortened(option) + "'",
                  {}, suggest_name(option, options, "options"));
  }
}

}  // namespace

int main(int argc, char** argv) {
  int status = 0;
  CLI::App app("Co-simulation of multibody machines with very many particles");
  app.name("tandem");
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text());
  add_run(app, status);
  add_validate(app, status);
  add_describe(app);
  add_preview(app);
  add_movie(app);
  add_modes(app);
  add_study(app, status);
  add_import(app);
  add_ps(app);
  add_stop(app);
  add_keys(app);
  add_conform(app, status);
  add_replay(app, status);
  add_new(app);
  app.add_subcommand("schema", "Print the JSON schema of scenes")->callback([] {
    fmt::print("{}\n", scene::schema());
  });

  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    expect_stack();
    log::setup("tandem");
    expect_utf8(words);
    expect_known_words(app, words);
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, version
    fmt::print(stderr, "error: {}\nRun with --help for more information.\n",
               printable(with_short_words(error.what(), words)));
    return exit_status(ErrorCode::usage);
  } catch (const Error& error) {
    fmt::print(stderr, "error: {}\n", printable(with_short_words(error.what(), words)));
    return exit_status(error.code());
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {} (a bug of tandem: please report it)\n", error.what());
    return exit_status(ErrorCode::internal);
  }
  return status;
}
