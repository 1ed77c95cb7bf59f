#include <unistd.h>

#include <atomic>
#include <future>

#include "channel_factory.hpp"
#include "forked_child.hpp"
#include "protocol/dds/dds_channel.hpp"

namespace tandem::protocol::test {
namespace {

using namespace std::chrono_literals;

// On the loopback, each pair in a run of its own.
DdsOptions next_run() {
  static std::atomic<int> number = 0;
  DdsOptions options;
  options.run = "conformance-" + std::to_string(getpid()) + "-" + std::to_string(number++);
  options.role = Role::dem;
  options.secret = "the secret of this test, long enough";
  return options;
}

}  // namespace

std::vector<ChannelFactory> dds_factories() {
  ChannelFactory factory;
  factory.name = "dds";
  factory.peer = name(Role::dem);
  factory.opens_with_peer = true;
  factory.allocation_free = false;
  factory.pair = []() -> Ends {
    const DdsOptions run = next_run();
    const Deadline deadline = Clock::now() + 10s;
    auto participant = std::async(std::launch::async, [&] { return open_dds_participant(run, deadline); });
    auto coordinator = open_dds_coordinator(run, deadline);
    return {std::move(coordinator), participant.get()};
  };
  factory.child = [](const std::function<void()>& before_attach, const std::function<void(Channel&)>& body) {
    const DdsOptions run = next_run();
    const Deadline deadline = Clock::now() + 10s;
    // The child begins before this process has any thread of DDS.
    auto child = std::make_unique<ForkedChild>([&] {
      before_attach();
      body(*open_dds_participant(run, deadline));
    });
    child->set_channel(open_dds_coordinator(run, deadline));
    return child;
  };
  return {factory};
}

}  // namespace tandem::protocol::test
