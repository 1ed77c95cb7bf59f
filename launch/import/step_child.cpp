#include "launch/import/step_child.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/error.hpp"
#include "common/input_file.hpp"

extern char** environ;

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

}  // namespace

// Beside this program; tests lie in a folder beside bin/.
fs::path step_reader() {
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& program : {folder / "tandem_step", folder.parent_path() / "bin" / "tandem_step"})
    if (fs::exists(program)) return program;
  return {};
}

namespace {

fs::path required_step_reader() {
  const fs::path program = step_reader();
  if (program.empty())
    throw Error(ErrorCode::usage, "this build of tandem reads no STEP files: it was made without OpenCASCADE",
                {}, "launch/install --cad installs it; then build again by launch/build");
  return program;
}

pid_t start(const fs::path& program, std::vector<std::string> arguments) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  pid_t pid = -1;
  const int error = posix_spawn(&pid, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw Error(ErrorCode::resource, std::string("cannot be started: ") + strerror(error), program.string(),
                "install all programs of tandem into one folder");
  return pid;
}

// The status of waitpid(), or nothing where the time ran out and the program was killed.
std::optional<int> wait_for(pid_t pid, std::chrono::seconds patience) {
  const int descriptor = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  const auto end = std::chrono::steady_clock::now() + patience;
  bool ended = false;
  while (!ended) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0) break;
    pollfd ending{descriptor, POLLIN, 0};
    ended = poll(&ending, 1, static_cast<int>(left.count())) > 0;
  }
  if (!ended) kill(pid, SIGKILL);
  int status = 0;
  waitpid(pid, &status, 0);
  close(descriptor);
  return ended ? std::optional(status) : std::nullopt;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "tandem_import_XXXXXX").string();
  if (!mkdtemp(name.data()))
    throw Error(ErrorCode::resource, std::string("cannot be made: ") + strerror(errno), name,
                "set TMPDIR to a folder that you may write to");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void run_tandem_step(const fs::path& file, const fs::path& folder, std::optional<double> deviation,
                     std::chrono::seconds patience) {
  const fs::path program = required_step_reader();
  std::vector<std::string> arguments{program.string(), fs::absolute(file).string(), folder.string()};
  if (deviation) arguments.push_back(fmt::format("{:.17g}", *deviation));
  const std::optional<int> status = wait_for(start(program, std::move(arguments)), patience);
  const auto fail = [&](const std::string& problem, const std::string& hint) {
    throw Error(ErrorCode::scene, problem, file.string(), hint);
  };
  if (!status)
    fail(fmt::format("could not be read within {} s", patience.count()),
         "import fewer parts, or simpler ones");
  if (WIFSIGNALED(*status))
    fail(fmt::format("OpenCASCADE crashed while it read this file ({}): it is damaged, or needs more than 8 "
                     "GiB of memory",
                     strsignal(WTERMSIG(*status))),
         "export it again, as AP214 or AP242, or with fewer parts");
  if (WEXITSTATUS(*status) == 0) return;
  const fs::path refusal = folder / "refusal.json";
  if (!fs::exists(refusal))
    fail(fmt::format("tandem_step ended with status {} and no word", WEXITSTATUS(*status)),
         "is all of OpenCASCADE installed? launch/install --cad installs it");
  const auto json = nlohmann::json::parse(read_input(refusal, {.largest = largest_text}));
  fail(json["problem"].get<std::string>(), json["hint"].get<std::string>());
}

}  // namespace tandem::launch
