#include "launch/conform/subject.hpp"

#include <cstdint>
#include <fstream>

#include "common/utf8.hpp"
#include "coordinator/start/processes.hpp"
#include "coordinator/start/watched_channel.hpp"
#include "protocol/endpoint.hpp"
#include "protocol/shm/shm_channel.hpp"
#include "protocol/stream/stream_channel.hpp"

namespace tandem::conform {
namespace {

using namespace std::chrono_literals;

class Started final : public Instance {
 public:
  Started(protocol::Endpoint endpoint, const launch::Command& command)
      : process_(command), channel_(std::move(endpoint.channel)) {}
  std::unique_ptr<protocol::Channel> take_channel() override {
    return launch::with_ending(std::move(channel_), process_);
  }
  std::optional<std::string> ending(std::chrono::milliseconds patience) override {
    return process_.ending(patience);
  }

 private:
  // Ends the process in its destructor, after the channel is closed.
  launch::Process process_;
  std::unique_ptr<protocol::Channel> channel_;
};

class Program final : public Subject {
 public:
  Program(protocol::Role role, launch::ServerCommand program, Transport transport, std::filesystem::path log)
      : role_(role), program_(std::move(program)), transport_(transport), log_(std::move(log)) {}

  protocol::Role role() const override { return role_; }

  std::unique_ptr<Instance> start(const std::filesystem::path& state_folder) override {
    std::error_code unknown;
    log_begin_ = std::filesystem::file_size(log_, unknown);
    if (unknown) log_begin_ = 0;
    const std::string name = launch::start_of(program_, role_, {}).name;
    protocol::Endpoint endpoint =
        transport_ == Transport::shm ? protocol::create_shm(name) : protocol::create_stream(name);
    std::vector<std::string> arguments = endpoint.server_arguments;
    if (!state_folder.empty()) arguments.insert(arguments.end(), {"--state-folder", state_folder.string()});
    launch::Command command = launch::start_of(program_, role_, arguments);
    command.log = log_;
    if (transport_ == Transport::stream)
      command.in_out = endpoint.inherited.front().get();
    else
      for (const protocol::Fd& descriptor : endpoint.inherited) command.inherited.push_back(descriptor.get());
    // The descriptors of the participant are closed here when the endpoint ends, after the start.
    const auto inherited = std::move(endpoint.inherited);
    return std::make_unique<Started>(std::move(endpoint), command);
  }

  std::string last_words() const override {
    std::ifstream file(log_, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(log_begin_));
    std::string line, last;
    while (std::getline(file, line))
      // The kit's command line gives this advice after an error.
      if (line.find_first_not_of(" \t\r") != std::string::npos &&
          line != "Run with --help for more information.")
        last = line;
    return printable(shortened(last, 300));
  }

 private:
  protocol::Role role_;
  launch::ServerCommand program_;
  Transport transport_;
  std::filesystem::path log_;
  std::uintmax_t log_begin_ = 0;  // size of the log at the last start
};

}  // namespace

std::unique_ptr<Subject> make_subject(protocol::Role role, launch::ServerCommand program, Transport transport,
                                      const std::filesystem::path& log) {
  return std::make_unique<Program>(role, std::move(program), transport, log);
}

}  // namespace tandem::conform
