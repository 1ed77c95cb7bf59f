#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "common/error.hpp"
#include "common/seconds.hpp"
#include "common/utf8.hpp"
#include "coordinator/run/run.hpp"
#include "coordinator/window/checkpoint.hpp"
#include "launch/study/study.hpp"
#include "launch/verbs/options.hpp"
#include "launch/verbs/verbs.hpp"

namespace tandem::launch {
namespace {

constexpr std::size_t longest_run_name = 128;  // as protocol/dds/dds_channel.cpp has it; less over shm

}  // namespace

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
  verb->add_option("--ranks", options->ranks,
                   "Processes that share the spheres, on the cores of this host or of --hosts, started by "
                   "mpirun; results "
                   "have the same bits for any number. --threads is then that of each")
      ->capture_default_str();
  verb->add_option("--hosts", options->hosts,
                   "Hosts of the ranks, as in node1,node2: this one first. mpirun reaches the others, by ssh "
                   "or by the "
                   "batch system, and finds tandem there in the same folder")
      ->delimiter(',');
  verb->add_option(
          "--transport", options->transport,
          "How the servers are reached: shm, inproc, dds, or stream, their standard input and output")
      ->transform(one_of(transports))
      ->default_str("shm");
  add_set(*verb, options->overrides.set);
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
  add_set(*verb, options->set);
  verb->add_option("--want", options->want,
                   "Print the cheapest setting with at most this error: position=1e-3");
  verb->callback([=, &status] { status = study(*options); });
}

}  // namespace tandem::launch
