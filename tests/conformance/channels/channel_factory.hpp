// What the conformance suite needs of a channel. To put another channel to the test, add one ChannelFactory
// to all_factories() in factories.cpp; nothing else changes.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "protocol/channel.hpp"

namespace tandem::protocol::test {

// The two ends in this process; first is the coordinator's.
using Ends = std::pair<std::unique_ptr<Channel>, std::unique_ptr<Channel>>;

// A participant in another process, to be killed.
class Child {
 public:
  virtual ~Child() = default;      // kills and reaps it if that has not happened
  virtual void kill() = 0;         // SIGKILL; stays a zombie until the destructor
  virtual Channel& channel() = 0;  // the coordinator's end
};

struct ChannelFactory {
  std::string name;
  std::function<Ends()> pair;
  // Runs `body` with the participant's end in a new process, after `before_attach`; empty where a channel
  // cannot leave its process. What `body` throws ends the child with status 1.
  std::function<std::unique_ptr<Child>(std::function<void()> before_attach,
                                       std::function<void(Channel&)> body)>
      child;
  // A peer that is killed is known to be within this time.
  std::chrono::milliseconds death_is_seen_in{1000};
  // How the coordinator's end names its peer.
  std::string peer = "participant";
  // Whether the coordinator's end opens only once the participant is there, so that there is no channel
  // before.
  bool opens_with_peer = false;
  // Whether a steady exchange is free of allocations inside the channel.
  bool allocation_free = true;
};

inline void PrintTo(const ChannelFactory& factory, std::ostream* out) {
  *out << factory.name;
}

// Only in a build with Cyclone DDS.
std::vector<ChannelFactory> dds_factories();

const std::vector<ChannelFactory>& all_factories();

}  // namespace tandem::protocol::test
