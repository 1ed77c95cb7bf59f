#include "coordinator/start/participants.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <random>

#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "common/utf8.hpp"
#include "coordinator/run_folder/own_files.hpp"
#include "coordinator/start/build_info.hpp"
#include "coordinator/start/rank_command.hpp"
#include "dem_server/coupling/make_solver.hpp"
#include "mbd_server/coupling/make_solver.hpp"
#include "protocol/dds/dds_channel.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/participant/serve.hpp"
#include "protocol/secret.hpp"
#include "protocol/shm/shm_channel.hpp"
#include "protocol/stream/stream_channel.hpp"
#include "sph_server/coupling/make_solver.hpp"

namespace tandem::launch {
namespace {

using namespace std::chrono_literals;
using protocol::Role;

double seconds(std::chrono::milliseconds time) {
  return std::chrono::duration<double>(time).count();
}

std::uint64_t random_id() {
  std::random_device device;
  return (std::uint64_t{device()} << 32) | device();
}

// The folders in which servers may read and write the states of this run, and no others.
std::vector<std::string> state_arguments(const RunOptions& options) {
  std::vector<std::string> arguments;
  const auto add = [&](const std::filesystem::path& folder) {
    arguments.insert(arguments.end(), {"--state-folder", std::filesystem::absolute(folder).string()});
  };
  if (options.checkpoint_every > 0) {
    const std::filesystem::path folder = options.folder / checkpoint_folder;
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure)
      throw Error(ErrorCode::resource, "cannot be created: " + failure.message(), folder.string(),
                  "free some space on the disk");
    add(folder);
  }
  if (!options.restart.empty()) add(options.restart);
  return arguments;
}

// Starts a foreign server, or ours where there is none, with these arguments after its own.
Command command_of(Role role, const std::optional<ServerCommand>& foreign,
                   const std::vector<std::string>& arguments, const std::vector<int>& inherited, int in_out,
                   const std::filesystem::path& log) {
  const std::string program = protocol::name(role);
  if (!foreign) return {program, program_folder() / program, arguments, inherited, in_out, log};
  Command command = start_of(*foreign, role, arguments);
  command.inherited = inherited;
  command.in_out = in_out;
  command.log = log;
  return command;
}

// Whether tandem's own program `name` wrote this line of the log (common/log.cpp has the format).
bool is_line_of(const std::string& line, const std::string& name) {
  const std::size_t after_time = line.find(' ');
  return after_time == 12 && line[2] == ':' && line[5] == ':' &&
         line.compare(13, name.size() + 1, name + ' ') == 0;
}

// A server in a thread of this process. It owns all that it uses, so that it may outlive the run.
template <class MakeSolver>
std::packaged_task<int()> server_task(std::unique_ptr<protocol::Channel> channel, Role role,
                                      MakeSolver make) {
  return std::packaged_task<int()>([channel = std::move(channel), role, make]() mutable {
    const auto own = std::move(channel);  // closed when the server leaves, not when the task is destroyed
    const auto solver = make();
    return protocol::serve(*own, *solver, fmt::format("{} {}", protocol::name(role), version));
  });
}

std::packaged_task<int()> own_server_task(std::unique_ptr<protocol::Channel> channel, Role role) {
  switch (role) {
    case Role::mbd:
      return server_task(std::move(channel), role, mbd::make_solver);
    case Role::dem:
      return server_task(std::move(channel), role, dem::make_solver);
    case Role::sph:
      break;
  }
  return server_task(std::move(channel), role, sph::make_solver);
}

}  // namespace

Participants::Participants(const RunOptions& options, const scene::Scene& scene,
                           const ForeignServers& foreign, const std::filesystem::path& log,
                           protocol::FrameSink* recorder)
    : log_(log) {
  std::error_code no_log;
  if (const std::uintmax_t size = std::filesystem::file_size(log, no_log); !no_log) log_begin_ = size;
  const protocol::RunIdentity identity{random_id(), 0};
  const std::string run =
      !options.run_name.empty() ? options.run_name : fmt::format("tandem-{:016x}", identity.run_id);
  const auto deadline = [&] { return protocol::Clock::now() + options.patience; };
  const std::vector<std::string> states = state_arguments(options);
  std::string secret;
  protocol::Fd inherited;  // descriptor of the secret, for servers that are started here
  if (options.transport == Transport::dds) {
    secret = protocol::take_secret(options.secret_file);
    if (options.insecure) secret.clear();
    if (!options.attach && !options.insecure) {
      if (secret.empty()) secret = protocol::make_secret();
      inherited = protocol::secret_to_inherit(secret);
    }
  }
  const auto with_states = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), states.begin(), states.end());
    return arguments;
  };
  const auto shm_name = [&](Role role) { return run + "-" + protocol::name(role); };
  const auto address = [&](Role role) -> std::vector<std::string> {
    if (options.transport == Transport::shm) return with_states({"--shm", shm_name(role)});
    std::vector<std::string> arguments{"--dds", run, "--interface", options.dds_interface};
    if (options.insecure) arguments.push_back("--insecure");
    if (!options.certificates.empty())
      arguments.insert(arguments.end(),
                       {"--certificates", std::filesystem::absolute(options.certificates).string()});
    if (const std::string file =
            inherited ? "/proc/self/fd/" + std::to_string(inherited.get()) : options.secret_file;
        !file.empty())
      arguments.insert(arguments.end(), {"--secret-file", file});
    if (options.lease)
      arguments.insert(arguments.end(), {"--lease", fmt::format("{:g}", seconds(*options.lease))});
    return with_states(std::move(arguments));
  };
  protocol::ShmOptions shm;
  if (options.lease) shm.lease = *options.lease;
  // While one server is waited for, any other may end.
  const auto watch = [this] {
    if (!begun_ && interrupted())
      throw Error(ErrorCode::interrupted, "the run was interrupted before its first window");
    if (const auto found = death(0ms)) throw Error(ErrorCode::peer_lost, found->sentence);
  };
  shm.idle = watch;

  std::vector<Role> roles;
  if (scene.mbd) roles.push_back(Role::mbd);
  if (scene.dem) roles.push_back(Role::dem);
  if (scene.sph) roles.push_back(Role::sph);
  for (const Role role : roles) {
    auto participant = std::make_unique<Participant>();
    participant->role = role;
    participants_.push_back(std::move(participant));
  }

  // All servers are started before waiting for the first, so that they start concurrently.
  std::vector<std::unique_ptr<protocol::Channel>> channels;
  for (auto& participant : participants_) {
    const Role role = participant->role;
    const std::string program = protocol::name(role);
    // A foreign program may call itself as it likes; its command tells it from ours.
    const bool on_ranks = role == Role::dem && options.ranks > 1;
    const std::string shown = foreign.of(role) ? start_of(*foreign.of(role), role, {}).name : program;
    std::unique_ptr<protocol::Channel> channel;
    const auto start = [&](const std::vector<std::string>& arguments, const std::vector<int>& descriptors,
                           int in_out = -1) {
      participant->process.emplace(command_of(role, foreign.of(role), arguments, descriptors, in_out, log));
      participant->foreign = foreign.of(role).has_value();
    };
    if (options.transport == Transport::inproc) {
      auto [own, theirs] = protocol::create_inproc(program);
      auto task = own_server_task(std::move(theirs), role);
      participant->thread_done = task.get_future();
      participant->thread = std::thread(std::move(task));
      channel = std::move(own);
    } else if (options.attach) {
      const std::string named = server_of_scene(role, scene);
      fmt::print("start: {} {}{}\n", program, fmt::join(address(role), " "),
                 named.empty()
                     ? ""
                     : fmt::format("  (the scene names the server '{}')", printable_line(shortened(named))));
      std::fflush(stdout);
    } else if (on_ranks) {
      // mpirun passes no descriptors on, so that rank 0 finds this process by a name.
      Command command = start_of_ranks(options, address(role));
      command.log = log;
      participant->process.emplace(command);
      participant->foreign = true;
    } else if (options.transport == Transport::shm) {
      protocol::Endpoint endpoint = protocol::create_shm(shown, shm);
      std::vector<int> descriptors;
      for (const protocol::Fd& descriptor : endpoint.inherited) descriptors.push_back(descriptor.get());
      start(with_states(endpoint.server_arguments), descriptors);
      endpoint.inherited.clear();
      channel = std::move(endpoint.channel);
    } else if (options.transport == Transport::stream) {
      protocol::Endpoint endpoint = protocol::create_stream(shown);
      start(with_states(endpoint.server_arguments), {}, endpoint.inherited.front().get());
      channel = std::move(endpoint.channel);
    } else {
      std::vector<std::string> arguments = address(role);
      arguments.insert(arguments.end(), {"--coordinator-pid", std::to_string(getpid())});
      const auto descriptors = inherited ? std::vector<int>{inherited.get()} : std::vector<int>{};
      start(arguments, descriptors);
    }
    channels.push_back(std::move(channel));
  }

  for (std::size_t i = 0; i < participants_.size(); ++i) {
    const Role role = participants_[i]->role;
    if (!channels[i] && options.transport == Transport::shm)
      channels[i] = protocol::connect_shm(shm_name(role), protocol::name(role), deadline(), shm);
    if (!channels[i]) {
      protocol::DdsOptions dds;
      dds.run = run;
      dds.role = role;
      dds.interface = options.dds_interface;
      if (!options.dds_peer.empty()) dds.peers = {options.dds_peer};
      dds.secret = secret;
      dds.insecure = options.insecure;
      dds.certificates = options.certificates;
      dds.idle = watch;
      if (options.lease) dds.lease = *options.lease;
      channels[i] = protocol::open_dds_coordinator(dds, deadline());
    }
    auto& remote = participants_[i]->remote;
    remote = std::make_unique<protocol::Remote>(std::move(channels[i]), role, identity, recorder);
    remote->set_patience(options.patience);
    remote->set_idle(watch);
  }
  // From now on each server gets signs of life, also one without messages for a long time.
  for (const auto& participant : participants_) participant->remote->peer_gone();
}

Participants::~Participants() {
  for (auto& participant : participants_)
    participant->remote.reset();  // closes the channel: the server leaves
  for (auto& participant : participants_) {
    if (!participant->thread.joinable()) continue;
    if (participant->thread_done.wait_for(5s) == std::future_status::ready) {
      participant->thread.join();
    } else {
      // A thread cannot be ended from outside; this one is inside a solver's step and owns all that it
      // uses.
      log::warn("{} is still busy; not waiting for it", protocol::name(participant->role));
      participant->thread.detach();
    }
  }
  for (auto& participant : participants_)
    if (participant->process) participant->process->ending(500ms);
}

Solvers Participants::solvers() const {
  Solvers solvers;
  for (const auto& participant : participants_)
    if (participant->role == Role::mbd)
      solvers.mbd = participant->remote.get();
    else
      solvers.loads.push_back(participant->remote.get());
  return solvers;
}

void Participants::fail(const Error& error) noexcept {
  for (auto& participant : participants_)
    if (participant->remote) participant->remote->fail(error);
}

std::optional<Participants::Death> Participants::death(std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  bool stopped = false;  // a stopped program is silent and does not end
  do {
    for (auto& participant : participants_) {
      if (!participant->process) continue;
      stopped |= participant->process->stopped();
      const auto ending = participant->process->ending(patience > 0ms ? 10ms : 0ms);
      if (ending && !(may_leave_ && *ending == Process::good_ending))
        return Death{participant->process->name() + " " + *ending,
                     participant->foreign ? last_words(participant->role) : ""};
    }
  } while (!stopped && std::chrono::steady_clock::now() < deadline);
  return {};
}

// The log is shared: lines that this program and our other servers wrote are not its words. Nor is the advice
// of the kit's command line after an error.
std::string Participants::last_words(Role role) const {
  std::ifstream file(log_, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(log_begin_));
  const auto is_of_another = [role](const std::string& line) {
    return is_line_of(line, "tandem") || std::ranges::any_of(protocol::all_roles, [&](Role other) {
             return other != role && is_line_of(line, protocol::name(other));
           });
  };
  std::string line, last;
  while (std::getline(file, line))
    if (line.find_first_not_of(" \t\r-") != std::string::npos && !is_of_another(line) &&
        line != "Run with --help for more information.")
      last = line;
  return printable(shortened(last, 300));
}

std::vector<Participants::Leaving> Participants::leave() {
  std::vector<Leaving> complaints;
  for (auto& participant : participants_) {
    if (!participant->process) continue;
    const auto ending = participant->process->ending(1s);
    if (!(ending && *ending == Process::good_ending))
      complaints.push_back({participant->process->name(), ending.value_or("")});
  }
  return complaints;
}

}  // namespace tandem::launch
