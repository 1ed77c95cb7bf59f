#include "coordinator/start/processes.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>

#include "common/error.hpp"
#include "common/interrupt.hpp"

extern char** environ;

namespace tandem::launch {

namespace {

// The environment of this process, with the command's folder of Python packages. `python` holds the text of
// the variable.
std::vector<char*> environment_of(const Command& command, std::string& python) {
  constexpr std::string_view variable = "PYTHONPATH=";
  std::vector<char*> environment;
  if (!command.python.empty()) python = std::string(variable) + command.python.string();
  for (char** entry = environ; *entry; ++entry) {
    const std::string_view text = *entry;
    if (!command.python.empty() && text.starts_with(variable))
      python = text.size() == variable.size() ? python : std::string(text) + ":" + command.python.string();
    else
      environment.push_back(*entry);
  }
  if (!python.empty()) environment.push_back(python.data());
  environment.push_back(nullptr);
  return environment;
}

}  // namespace

std::filesystem::path program_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

Process::Process(const std::string& program, const std::vector<std::string>& arguments,
                 const std::vector<int>& inherited, const std::filesystem::path& log)
    : Process({program, program_folder() / program, arguments, inherited, -1, log}) {}

Process::Process(const Command& command) {
  const std::string path = command.program.string();
  std::vector<char*> argv{const_cast<char*>(path.c_str())};
  for (const std::string& argument : command.arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  // A dup2 to the same descriptor clears close-on-exec (POSIX.1-2024, glibc since 2.29).
  for (int descriptor : command.inherited) posix_spawn_file_actions_adddup2(&actions, descriptor, descriptor);
  if (command.in_out < 0) {
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  } else {
    posix_spawn_file_actions_adddup2(&actions, command.in_out, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, command.in_out, STDOUT_FILENO);
  }
  if (command.watched >= 0) posix_spawn_file_actions_adddup2(&actions, command.watched, 3);
  if (!command.log.empty()) {
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, command.log.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0644);
    // A child of a foreign program may outlive the run. Whoever reads our output must not wait for it.
    if (command.foreign && command.in_out < 0)
      posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  }

  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t defaults;
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGINT);
  sigaddset(&defaults, SIGTERM);
  // This process ignores SIGPIPE and handles stream errors; a controller may rely on the default.
  sigaddset(&defaults, SIGPIPE);
  sigaddset(&defaults, SIGXFSZ);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  // systemd and batch systems send these to all programs of a run: this one needs the others for the end of
  // the window and the checkpoint, and ends them itself.
  sigset_t held;
  pthread_sigmask(SIG_SETMASK, nullptr, &held);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&held, signal);
  posix_spawnattr_setsigmask(&attributes, &held);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);

  std::string python;
  const std::vector<char*> environment = environment_of(command, python);
  const StartGuard start;
  const int error = posix_spawn(&pid_, path.c_str(), &actions, &attributes, argv.data(), environment.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw Error(ErrorCode::resource, "cannot be started: " + std::string(strerror(error)), path,
                command.foreign ? "a script needs a first line such as #!/usr/bin/env python3 that names a "
                                  "program of this computer"
                                : "build it, or install all programs of tandem into one folder");
  }
  foreign_ = command.foreign;
  name_ = command.name + " (pid " + std::to_string(pid_) + ")";
  // The child is not reaped yet, so that its pid cannot belong to another process.
  pidfd_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  if (pidfd_ < 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    throw Error(ErrorCode::resource, "pidfd_open failed: " + std::string(strerror(errno)), name_);
  }
  if (foreign_) end_with_us(pid_);
}

Process::Process(Process&& other) noexcept
    : name_(std::move(other.name_)),
      pid_(other.pid_),
      pidfd_(other.pidfd_),
      foreign_(other.foreign_),
      ending_(std::move(other.ending_)) {
  other.pid_ = other.pidfd_ = -1;
}

Process::~Process() {
  if (pid_ < 0) return;
  using namespace std::chrono_literals;
  if (!ending(0ms)) {
    // The process leads its process group.
    const int whom = foreign_ ? -pid_ : pid_;
    kill(whom, SIGTERM);
    if (!ending(250ms)) {
      kill(whom, SIGKILL);  // also ends a stopped process
      ending(5s);
    }
  }
  if (foreign_) outlives_us(pid_);
  close(pidfd_);
}

std::optional<std::string> Process::ending(std::chrono::milliseconds patience) {
  if (ending_ || pid_ < 0) return ending_;
  const auto deadline = std::chrono::steady_clock::now() + patience;
  pollfd watched{pidfd_, POLLIN, 0};
  int ready = 0;
  do {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    ready = poll(&watched, 1, static_cast<int>(std::max<std::int64_t>(0, left.count())));
  } while (ready < 0 && errno == EINTR);
  if (ready <= 0) return {};
  // Before the process is reaped its number cannot belong to another group.
  if (foreign_) {
    kill(-pid_, SIGKILL);
    outlives_us(pid_);
  }
  int status = 0;
  if (waitpid(pid_, &status, 0) != pid_) return ending_ = "is gone";
  if (WIFSIGNALED(status)) {
    const int number = WTERMSIG(status);
    return ending_ = "was killed by signal " + std::to_string(number) + " (" + strsignal(number) + ")";
  }
  return ending_ = "exited with status " + std::to_string(WEXITSTATUS(status));
}

bool Process::stopped() const {
  if (ending_ || pid_ < 0) return false;
  siginfo_t info{};
  return waitid(P_PIDFD, static_cast<id_t>(pidfd_), &info, WSTOPPED | WNOHANG | WNOWAIT) == 0 &&
         info.si_pid == pid_;
}

}  // namespace tandem::launch
