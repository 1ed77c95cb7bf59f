#include "coordinator/report/tool.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <thread>

#include "common/interrupt.hpp"
#include "common/log.hpp"

namespace tandem::launch {
namespace {

constexpr int not_found = 127;  // exit status of a child that could not execute the tool, as in a shell

int signal_of_interrupt(const Tool& tool) {
  return tool.ends_in_order ? SIGHUP : SIGKILL;
}

pid_t start(const Tool& tool) {
  // All allocations are made before the fork.
  const std::string folder = tool.folder.string(), log_file = tool.log.string();
  std::vector<char*> arguments = {const_cast<char*>(tool.program.c_str())};
  for (const std::string& argument : tool.arguments) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);

  const pid_t parent = getpid(), child = fork();
  if (child != 0) return child;
  // Of the thread that waits for it.
  prctl(PR_SET_PDEATHSIG, signal_of_interrupt(tool));
  if (getppid() != parent) _exit(not_found - 1);
  if (tool.ends_in_order) {
    setpgid(0, 0);
    signal(SIGHUP, SIG_DFL);  // also under nohup
  }
  const int out = open(log_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int in = open("/dev/null", O_RDONLY);
  if (out < 0 || in < 0 || chdir(folder.c_str()) != 0) _exit(not_found - 1);
  // This process ignores SIGPIPE and handles stream errors; the tool may rely on the default.
  signal(SIGPIPE, SIG_DFL);
  signal(SIGXFSZ, SIG_DFL);
  dup2(in, STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(out, STDERR_FILENO);
  execvp(arguments[0], arguments.data());
  _exit(not_found);
}

}  // namespace

ToolEnd wait_for_tool(const Tool& tool) {
  ToolEnd end;
  const pid_t child = start(tool);
  if (child < 0) return end;
  end.started = true;
  const auto deadline = std::chrono::steady_clock::now() + tool.patience;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (interrupted() && !end.interrupted) {
      end.interrupted = true;
      kill(child, signal_of_interrupt(tool));
    }
    if (std::chrono::steady_clock::now() > deadline) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      end.timed_out = true;
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (WIFEXITED(status)) end.status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  return end;
}

bool run_tool(const Tool& tool) {
  const ToolEnd end = wait_for_tool(tool);
  const bool missing = end.status == not_found;
  if (end.status == 0 || missing || end.interrupted) std::filesystem::remove(tool.log);
  if (end.status == 0) return true;
  if (end.interrupted) return false;
  if (!end.started) {
    log::warn("{} could not be started: {}", tool.program, std::strerror(errno));
  } else if (end.timed_out) {
    log::warn("{} was stopped after {} s; its output is in {}", tool.program, tool.patience.count(),
              tool.log.string());
  } else if (missing) {
    log::warn("{} is not there: apt-get install {}", tool.program, tool.package);
  } else {
    log::warn("{} failed ({} {}); its output is in {}", tool.program, end.signal == 0 ? "status" : "signal",
              end.signal == 0 ? end.status : end.signal, tool.log.string());
  }
  return false;
}

}  // namespace tandem::launch
