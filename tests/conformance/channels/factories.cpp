#include <algorithm>
#include <iterator>

#include "channel_factory.hpp"
#include "forked_child.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/shm/shm_channel.hpp"

namespace tandem::protocol::test {
namespace {

using namespace std::chrono_literals;

ChannelFactory inproc(const std::string& name, WaitPolicy wait) {
  return {.name = name, .pair = [wait] { return create_inproc("participant", wait); }, .child = {}};
}

// A small ring, so that frames wrap around and stream through.
ChannelFactory shm(const std::string& name, const ShmOptions& options) {
  ChannelFactory factory{.name = name, .pair = {}, .child = {}};
  factory.pair = [options]() -> Ends {
    Endpoint endpoint = create_shm("participant", options);
    const std::string address = endpoint.server_arguments.at(1);
    static_cast<void>(endpoint.inherited.at(0).release());  // attach_shm owns it from here on
    auto participant = attach_shm(address, Clock::now() + 1s, options.wait);
    return {std::move(endpoint.channel), std::move(participant)};
  };
  factory.child = [options](const std::function<void()>& before_attach,
                            const std::function<void(Channel&)>& body) {
    Endpoint endpoint = create_shm("participant", options);
    auto child = std::make_unique<ForkedChild>([&] {
      endpoint.channel.reset();  // as exec() would do
      before_attach();
      const auto channel = attach_shm(endpoint.server_arguments.at(1), Clock::now() + 5s, options.wait);
      body(*channel);
    });
    child->set_channel(std::move(endpoint.channel));
    return child;
  };
  return factory;
}

}  // namespace

const std::vector<ChannelFactory>& all_factories() {
  static const std::vector<ChannelFactory> factories = [] {
    std::vector<ChannelFactory> all{
        inproc("inproc", WaitPolicy::adaptive),
        inproc("inproc_block", WaitPolicy::block),
        shm("shm", {}),
        shm("shm_block", {.wait = WaitPolicy::block}),
        shm("shm_small_ring", {.ring_bytes = 4096}),
    };
#if TANDEM_WITH_DDS
    std::ranges::move(dds_factories(), std::back_inserter(all));
#endif
    return all;
  }();
  return factories;
}

}  // namespace tandem::protocol::test
