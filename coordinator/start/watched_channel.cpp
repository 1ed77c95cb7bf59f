#include "coordinator/start/watched_channel.hpp"

#include <utility>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

using namespace std::chrono_literals;
using protocol::Deadline;

class WatchedChannel final : public protocol::Channel {
  template <class Call>
  auto explained(Call call) {
    try {
      return call();
    } catch (const Error& error) {
      if (error.code() != ErrorCode::peer_lost) throw;
      // The channel may detect the end earlier than the kernel reports it.
      const auto ending = process_.ending(300ms);
      if (!ending) throw;
      throw Error(ErrorCode::peer_lost, process_.name() + " " + *ending, error.where(), error.hint());
    }
  }

 public:
  WatchedChannel(std::unique_ptr<protocol::Channel> channel, Process& process)
      : channel_(std::move(channel)), process_(process) {}

  void send(std::span<const std::span<const std::byte>> parts, Deadline deadline) override {
    explained([&] { channel_->send(parts, deadline); });
  }
  bool wait(Deadline deadline) override {
    return explained([&] { return channel_->wait(deadline); });
  }
  void receive(std::vector<std::byte>& frame, Deadline deadline) override {
    explained([&] { channel_->receive(frame, deadline); });
  }
  bool peer_gone() noexcept override { return channel_->peer_gone(); }
  const char* transport() const override { return channel_->transport(); }
  const std::string& peer() const override { return channel_->peer(); }

 private:
  std::unique_ptr<protocol::Channel> channel_;
  Process& process_;
};

}  // namespace

std::unique_ptr<protocol::Channel> with_ending(std::unique_ptr<protocol::Channel> channel, Process& process) {
  return std::make_unique<WatchedChannel>(std::move(channel), process);
}

}  // namespace tandem::launch
