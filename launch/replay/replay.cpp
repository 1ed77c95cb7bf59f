#include "launch/replay/replay.hpp"

#include <fmt/format.h>

#include <future>
#include <optional>
#include <thread>

#include "common/log.hpp"
#include "coordinator/start/build_info.hpp"
#include "coordinator/start/processes.hpp"
#include "coordinator/start/server_command.hpp"
#include "coordinator/start/watched_channel.hpp"
#include "dem_server/coupling/make_solver.hpp"
#include "mbd_server/coupling/make_solver.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/participant/serve.hpp"
#include "protocol/replay.hpp"
#include "protocol/shm/shm_channel.hpp"
#include "protocol/stream/stream_channel.hpp"
#include "sph_server/coupling/make_solver.hpp"

namespace tandem::launch {
namespace {

using namespace std::chrono_literals;
using protocol::Role;

// Our solver in a thread of this process. It owns all that it uses: one that does not answer any more cannot
// be ended, and is left behind.
class OwnSolver {
 public:
  explicit OwnSolver(Role role) {
    auto [own, theirs] = protocol::create_inproc(protocol::name(role));
    channel_ = std::move(own);
    std::packaged_task<int()> task([channel = std::move(theirs), role]() mutable {
      const auto end = std::move(channel);  // closed when the solver leaves, not when the task is destroyed
      const std::string program = fmt::format("{} {}", protocol::name(role), version);
      if (role == Role::mbd) return protocol::serve(*end, *mbd::make_solver(), program);
      if (role == Role::sph) return protocol::serve(*end, *sph::make_solver(), program);
      return protocol::serve(*end, *dem::make_solver(), program);
    });
    done_ = task.get_future();
    thread_ = std::thread(std::move(task));
  }
  ~OwnSolver() {
    channel_.reset();
    if (done_.wait_for(5s) == std::future_status::ready)
      thread_.join();
    else
      thread_.detach();
  }
  OwnSolver(const OwnSolver&) = delete;
  OwnSolver& operator=(const OwnSolver&) = delete;
  protocol::Channel& channel() { return *channel_; }

 private:
  std::unique_ptr<protocol::Channel> channel_;
  std::future<int> done_;
  std::thread thread_;
};

protocol::ReplayResult against_program(const protocol::Replay& recording, const ReplayOptions& options) {
  const ServerCommand server = find_server(options.server, ".", "--server");
  const std::string name = start_of(server, options.role, {}).name;
  protocol::Endpoint endpoint = options.stream ? protocol::create_stream(name) : protocol::create_shm(name);
  std::vector<std::string> arguments = endpoint.server_arguments;
  if (!recording.state_folder().empty())
    arguments.insert(arguments.end(), {"--state-folder", recording.state_folder().string()});
  Command command = start_of(server, options.role, arguments);
  if (options.stream)
    command.in_out = endpoint.inherited.front().get();
  else
    for (const protocol::Fd& descriptor : endpoint.inherited) command.inherited.push_back(descriptor.get());
  Process process(command);
  endpoint.inherited.clear();
  auto channel = with_ending(std::move(endpoint.channel), process);
  protocol::ReplayResult result = recording.against(*channel, options.patience);
  channel.reset();
  process.ending(500ms);
  return result;
}

protocol::ReplayResult against_own(const protocol::Replay& recording, const ReplayOptions& options) {
  log::setup("tandem", "off");  // the result has what the solver would log
  OwnSolver solver(options.role);
  return recording.against(solver.channel(), options.patience);
}

}  // namespace

int replay(const ReplayOptions& options) {
  const protocol::Replay recording(options.recording, options.role);
  const char* participant = protocol::name(options.role);
  const bool own = options.server.empty() || options.server == participant;
  if (own && options.stream)
    throw Error(ErrorCode::usage, "the solver of tandem runs inside this process", "--transport stream",
                fmt::format("give its program as --server {}/{}", program_folder().string(), participant));
  const protocol::ReplayResult result =
      own ? against_own(recording, options) : against_program(recording, options);
  if (result.difference)
    fmt::print("different: {}\n{} answers before it are equal\n", *result.difference, result.compared);
  else
    fmt::print("equal: {} answers of {} in {} windows have the bits of the recording\n", result.compared,
               participant, result.windows);
  if (recording.not_read() > 0) fmt::print("{}\n", cut_off(recording.not_read()));
  if (result.ending) fmt::print("the recording ends without a report: {}\n", *result.ending);
  if (result.not_kept > 0)
    fmt::print("{} answers are not compared, because the recording does not have their values\n",
               result.not_kept);
  if (result.not_possible > 0)
    fmt::print("{} orders to linearise or keep a frame are left out, because this participant cannot\n",
               result.not_possible);
  if (result.not_repeated > 0)
    fmt::print(
        "{} orders to write a restart file are not repeated, because it would replace that of the run\n",
        result.not_repeated);
  fmt::print("not compared: the facts of the participant, which are about machine and time\n");
  return result.difference ? 1 : 0;
}

}  // namespace tandem::launch
