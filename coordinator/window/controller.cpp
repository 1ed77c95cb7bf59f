#include "coordinator/window/controller.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "common/interrupt.hpp"
#include "common/scene/columns.hpp"
#include "common/utf8.hpp"

namespace tandem::launch {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr const char* where = "controller";
constexpr const char* page = "docs/control.md describes the lines";
constexpr std::size_t longest_line = 1 << 20;  // [bytes]

// A shell in the program's process group reads a pipe that closes when this process ends for any reason, and
// then kills the whole group. This also ends a program that ignores the end of its input, and its children.
const std::string ends_with_this_process = "(read end; kill -KILL 0) <&3 >/dev/null 2>&1 & exec 3<&-; exec ";

}  // namespace

ControllerProgram::ControllerProgram(const std::string& command, const scene::Scene& scene,
                                     std::chrono::milliseconds patience, const std::filesystem::path& log)
    : command_(command),
      sensor_names_(scene.mbd->sensors),
      input_names_(scene::control_inputs(*scene.mbd)),
      patience_(patience),
      inputs_(input_names_.size()) {
  // A socket, not two pipes: writing to a program that has ended is then an error, not a signal.
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw Error(ErrorCode::resource, "socketpair failed: " + std::string(strerror(errno)), where);
  ours_ = protocol::Fd(ends[0]);
  const protocol::Fd theirs(ends[1]);
  int pipe_ends[2];
  if (pipe2(pipe_ends, O_CLOEXEC) != 0)
    throw Error(ErrorCode::resource, "pipe2 failed: " + std::string(strerror(errno)), where);
  const protocol::Fd watched(pipe_ends[0]);
  alive_ = protocol::Fd(pipe_ends[1]);
  process_.emplace(Command{
      where, "/bin/sh", {"-c", ends_with_this_process + command}, {}, theirs.get(), log, watched.get()});
  send(Json{{"scene", scene.name},
            {"window", scene.coupling.window},
            {"end_time", scene.end_time},
            {"sensors", sensor_names_},
            {"inputs", input_names_}}
           .dump(),
       {});
}

// Closing its input requests the program to end; one that continues is killed.
ControllerProgram::~ControllerProgram() {
  ours_ = protocol::Fd();
  if (process_) process_->ending(1s);
}

const std::vector<double>& ControllerProgram::inputs(Nanoseconds now, const std::vector<double>& sensors) {
  Json values = Json::object();
  for (std::size_t i = 0; i < sensor_names_.size(); ++i) values[sensor_names_[i]] = sensors[i];
  expect_silence(now);
  send(Json{{"time", to_seconds(now)}, {"sensors", values}}.dump(), now);
  read(receive(now), now);
  expect_silence(now);
  return inputs_;
}

void ControllerProgram::send(const std::string& line, Nanoseconds now) {
  const std::string text = line + "\n";
  const Clock::time_point deadline = Clock::now() + patience_;
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n =
        ::send(ours_.get(), text.data() + sent, text.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n > 0) {
      sent += static_cast<std::size_t>(n);
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (Clock::now() > deadline || interrupted())
        fail(ErrorCode::timeout,
             fmt::format("does not read: waited {:.3g} s", std::chrono::duration<double>(patience_).count()),
             now, page);
      pollfd writable{ours_.get(), POLLOUT, 0};
      poll(&writable, 1, 50);
    } else if (errno != EINTR) {
      fail_as_gone(now);
    }
  }
}

std::string ControllerProgram::receive(Nanoseconds now) {
  const Clock::time_point deadline = Clock::now() + patience_;
  for (;;) {
    if (const std::size_t end = pending_.find('\n'); end != std::string::npos) {
      const std::string line = pending_.substr(0, end);
      pending_.erase(0, end + 1);
      return line;
    }
    if (pending_.size() > longest_line)
      fail(ErrorCode::protocol, "sent more than 1 MiB without the end of a line", now, page);
    if (interrupted()) fail(ErrorCode::interrupted, "was waited for", now);
    if (Clock::now() > deadline)
      fail(ErrorCode::timeout,
           fmt::format("did not answer within {:.3g} s", std::chrono::duration<double>(patience_).count()),
           now, "it has to flush each line; --patience gives it more time");
    pollfd readable{ours_.get(), POLLIN, 0};
    if (poll(&readable, 1, 50) <= 0) continue;
    char bytes[4096];
    const ssize_t n = recv(ours_.get(), bytes, sizeof bytes, 0);
    if (n > 0)
      pending_.append(bytes, static_cast<std::size_t>(n));
    else if (n == 0 || (errno != EINTR && errno != EAGAIN))
      fail_as_gone(now);
  }
}

// With more answers than requests it would be unknown to which request an answer belongs.
void ControllerProgram::expect_silence(Nanoseconds now) {
  char bytes[256];
  const ssize_t n = recv(ours_.get(), bytes, sizeof bytes, MSG_DONTWAIT);
  if (n > 0) pending_.append(bytes, static_cast<std::size_t>(n));
  if (!pending_.empty())
    fail(ErrorCode::protocol,
         "sent '" + shortened(pending_.substr(0, pending_.find('\n'))) + "' without being asked", now,
         "answer each line with \"time\" once; docs/control.md describes the lines");
}

// {"inputs": {"motor": 1.5}}: every input of the scene, each once, and nothing else.
void ControllerProgram::read(const std::string& line, Nanoseconds now) {
  const auto refuse = [&](const std::string& problem) {
    fail(ErrorCode::protocol, "answered '" + shortened(line) + "': " + problem, now, page);
  };
  // Of two equal keys the library would keep one, and the program may mean the other.
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  std::optional<std::string> twice;
  const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
      twice = parsed.get<std::string>();
    return true;
  };
  const Json answer = Json::parse(line, watch, false);
  if (!answer.is_object() || !answer.contains("inputs") || !answer["inputs"].is_object())
    refuse("no JSON object with \"inputs\"");
  if (twice) refuse("the key '" + shortened(*twice) + "' is given twice");
  for (const auto& item : answer.items())
    if (item.key() != "inputs") refuse("the key '" + shortened(item.key()) + "' is unknown");
  const Json& given = answer["inputs"];
  for (std::size_t i = 0; i < input_names_.size(); ++i) {
    const auto found = given.find(input_names_[i]);
    if (found == given.end()) refuse("input '" + input_names_[i] + "' is missing");
    if (!found->is_number()) refuse("input '" + input_names_[i] + "' is no number");
    inputs_[i] = found->get<double>();
  }
  if (given.size() == input_names_.size()) return;
  for (const auto& item : given.items())
    if (std::find(input_names_.begin(), input_names_.end(), item.key()) == input_names_.end())
      refuse("the scene has no input '" + shortened(item.key()) + "'");
}

void ControllerProgram::fail(ErrorCode code, const std::string& problem, Nanoseconds now,
                             const std::string& hint) {
  throw Error(code, fmt::format("{} at t = {:.6g} s", problem, to_seconds(now)),
              where + (" '" + shortened(command_) + "'"), hint);
}

void ControllerProgram::fail_as_gone(Nanoseconds now) {
  const auto ending = process_->ending(1s);
  fail(ErrorCode::peer_lost, ending ? *ending : "closed its output", now,
       "its own messages are in run.log; it has to answer until its input ends");
}

}  // namespace tandem::launch
