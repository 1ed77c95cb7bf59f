#include "protocol/participant/main.hpp"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <optional>
#include <thread>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/seconds.hpp"
#include "common/stack_limit.hpp"
#include "common/stream_signals.hpp"
#include "common/utf8.hpp"
#include "protocol/dds/dds_channel.hpp"
#include "protocol/participant/serve.hpp"
#include "protocol/secret.hpp"
#include "protocol/shm/shm_channel.hpp"
#include "protocol/stream/stream_channel.hpp"
#include "protocol/version.hpp"

namespace tandem::protocol {
namespace {

using namespace std::chrono_literals;

// Time that a server started by the user waits for its coordinator.
constexpr auto coordinator_patience = 10min;
// Defaults of a server's --lease and --patience [s].
constexpr double standard_lease = 0.4, standard_patience = 3600;

Role role_of(const MotionSolver&) {
  return Role::mbd;
}
Role role_of(const LoadSolver& solver) {
  return solver.role();
}

struct Options {
  std::optional<std::string> shm, stream;
  std::string dds, interface = "lo", log_level = "info", log_file;
  std::string secret_file, certificates;
  bool insecure = false;
  std::vector<std::string> peers, state_folders;
  double lease = standard_lease, patience = standard_patience;  // [s]
  int coordinator = 0;                                          // process that started this one; 0: a user
};

// Systemd and batch systems send SIGTERM, and a closed terminal SIGHUP, to all programs of a run at once. The
// coordinator needs this one for the end of the window and the checkpoint: the first of each has no effect, a
// second one ends this program.
void outlive_first_signals() {
  sigset_t held;
  sigemptyset(&held);
  for (const int signal : {SIGTERM, SIGHUP}) {
    sigaddset(&held, signal);
    struct sigaction before {};
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    struct sigaction once {};
    once.sa_handler = [](int) {};
    once.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
    sigaction(signal, &once, nullptr);
  }
  pthread_sigmask(SIG_UNBLOCK, &held, nullptr);  // the coordinator has held them back
}

bool is_started_by_coordinator(const Options& options) {
  return options.shm ? started_by_coordinator(*options.shm) : options.stream || options.coordinator > 0;
}

std::unique_ptr<Channel> open(const Options& options, Role role) {
  const Deadline deadline = Clock::now() + coordinator_patience;
  if (options.shm) {
    if (!started_by_coordinator(*options.shm))
      log::info("waiting for a coordinator under the name {}", shortened(*options.shm));
    return attach_shm(*options.shm, deadline);
  }
  if (options.stream) return attach_stream(*options.stream);
  DdsOptions dds;
  dds.run = options.dds;
  dds.role = role;
  dds.interface = options.interface;
  dds.peers = options.peers;
  const std::string secret = take_secret(options.secret_file);
  if (!options.insecure) dds.secret = secret;
  dds.insecure = options.insecure;
  dds.certificates = options.certificates;
  if (options.insecure)
    log::warn("--insecure: whoever reaches interface {} may read and change this run", options.interface);
  dds.lease = bounded_seconds(options.lease, least_lease, most_lease, "--lease");
  // A coordinator that dies before the connection is established has no lease that could run out.
  if (options.coordinator > 0)
    dds.idle = [pid = options.coordinator] {
      if (getppid() != pid)
        throw Error(ErrorCode::peer_lost,
                    "coordinator (pid " + std::to_string(pid) + ") died before it had met this server");
    };
  return open_dds_participant(dds, deadline);
}

// While the solver works, serve() does not detect the death of the coordinator until the solver returns. This
// ends the process after a short delay, in which serve() may detect it and end in order.
class Watch {
 public:
  Watch(Channel& channel, const std::atomic<std::uint64_t>& window)
      : thread_([&channel, &window](const std::stop_token& stop) {
          std::mutex mutex;
          std::condition_variable_any sleep;
          std::unique_lock lock(mutex);
          while (!channel.peer_gone())
            if (sleep.wait_for(lock, stop, 100ms, [] { return false; }) || stop.stop_requested()) return;
          sleep.wait_for(lock, stop, 400ms, [] { return false; });
          if (stop.stop_requested()) return;
          log::error("{} was lost in window {}, while this solver was at work", channel.peer(),
                     window.load());
          spdlog::shutdown();
          std::_Exit(exit_status(ErrorCode::peer_lost));
        }) {}

 private:
  std::jthread thread_;
};

template <class AnySolver>
int run(int argc, char** argv, const Program& itself,
        const std::function<std::unique_ptr<AnySolver>()>& make) {
  take_stream_signals_as_errors();
  const auto& [program, release] = itself;
  const std::vector<std::string> words(argv + 1, argv + argc);
  Options options;
  CLI::App app(release + ": a participant of a tandem run; the coordinator sends it scene and orders",
               program);
  auto* shm =
      app.add_option("--shm", options.shm, "Meet the coordinator on this host under NAME")->type_name("NAME");
  auto* dds =
      app.add_option("--dds", options.dds, "Meet the coordinator of RUN through DDS")->type_name("RUN");
  shm->excludes(dds);
  auto* stream = app.add_option("--stream", options.stream,
                                "\"-\": standard input and output are a stream of frames to the coordinator "
                                "that started this program")
                     ->type_name("-")
                     ->excludes(shm)
                     ->excludes(dds);
  app.add_option("--interface", options.interface, "DDS: network interface; no other is used")
      ->type_name("IF")
      ->capture_default_str()
      ->needs(dds);
  app.add_option("--peer", options.peers, "DDS: address of the coordinator's host")
      ->type_name("HOST")
      ->needs(dds);
  auto* secret =
      app.add_option("--secret-file", options.secret_file,
                     "DDS: file with the run's secret, which only its owner may read; without it the "
                     "environment's TANDEM_SECRET counts")
          ->type_name("FILE")
          ->needs(dds);
  auto* certificates =
      app.add_option(
             "--certificates", options.certificates,
             "DDS: folder of certificates that tandem keys has made; only ends that have it take part, and "
             "all is encrypted")
          ->type_name("DIR")
          ->needs(dds);
  app.add_flag("--insecure", options.insecure,
               "DDS: without a secret; whoever reaches the network may read and change the run")
      ->needs(dds)
      ->excludes(secret)
      ->excludes(certificates);
  app.add_option("--lease", options.lease,
                 "DDS: this server counts as lost when it is silent for so long [s]; over shared memory the "
                 "coordinator sets that")
      ->capture_default_str()
      ->needs(dds);
  app.add_option("--patience", options.patience, "Longest wait for the coordinator's next order [s]")
      ->capture_default_str();
  app.add_option("--state-folder", options.state_folders,
                 "Folder in which states may be written and read; without one, none are")
      ->type_name("FOLDER");
  app.add_option("--coordinator-pid", options.coordinator,
                 "DDS: the process that started this one; it leaves when that is gone")
      ->type_name("PID")
      ->needs(dds);
  app.add_option("--log-level", options.log_level, "error, warn, info or debug")
      ->type_name("LEVEL")
      ->capture_default_str()
      ->check(CLI::IsMember({"error", "warn", "info", "debug"}));
  app.add_option("--log-file", options.log_file, "Write the log here as well")->type_name("FILE");
  app.set_version_flag("--version", release + ", protocol " + std::to_string(protocol_version.major) + "." +
                                        std::to_string(protocol_version.minor));
  try {
    app.parse(argc, argv);
    if (shm->empty() && dds->empty() && stream->empty())
      throw CLI::RequiredError("--shm NAME, --stream - or --dds RUN");
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // help, version
    std::fprintf(stderr, "error: %s\nRun with --help for more information.\n",
                 printable(with_short_words(e.what(), words)).c_str());
    return exit_status(ErrorCode::usage);
  }
  try {
    log::setup(program, options.log_level, options.log_file);
    expect_stack();
    expect_open_files();
    const StateFolders folders(options.state_folders);
    const auto patience = bounded_seconds(options.patience, least_patience, most_patience, "--patience");
    if (is_started_by_coordinator(options)) {
      // Ctrl-C reaches the whole process group; the coordinator ends the run in order.
      std::signal(SIGINT, SIG_IGN);
      outlive_first_signals();
    }
    const std::unique_ptr<AnySolver> solver = make();
    const std::unique_ptr<Channel> channel = open(options, role_of(*solver));
    // One that a user has started ends at once while it waits for its run.
    if (!is_started_by_coordinator(options)) outlive_first_signals();
    std::atomic<std::uint64_t> window = 0;
    const Watch watch(*channel, window);
    return serve(*channel, *solver, release, {&window, &folders, patience});
  } catch (const Error& e) {
    log::error("{}", printable(with_short_words(e.what(), words)));
    return exit_status(e.code());
  } catch (const std::exception& e) {
    log::error("{}", e.what());
    return exit_status(ErrorCode::internal);
  }
}

}  // namespace

Program own_program(const std::string& name) {
  return {name, name + " " + TANDEM_VERSION};
}

int participant_main(int argc, char** argv, const Program& program,
                     const std::function<std::unique_ptr<MotionSolver>()>& make) {
  return run(argc, argv, program, make);
}
int participant_main(int argc, char** argv, const Program& program,
                     const std::function<std::unique_ptr<LoadSolver>()>& make) {
  return run(argc, argv, program, make);
}

}  // namespace tandem::protocol
