#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iterator>

#include "channel_factory.hpp"
#include "forked_child.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/shm/shm_channel.hpp"
#include "protocol/stream/stream_channel.hpp"

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

ChannelFactory stream() {
  ChannelFactory factory{.name = "stream", .pair = {}, .child = {}};
  factory.pair = []() -> Ends {
    Endpoint endpoint = create_stream("participant", StreamContent::any);
    const int theirs = endpoint.inherited.front().get();
    return {std::move(endpoint.channel), make_stream(theirs, theirs, "coordinator")};
  };
  factory.child = [](const std::function<void()>& before_attach, const std::function<void(Channel&)>& body) {
    Endpoint endpoint = create_stream("participant", StreamContent::any);
    const int theirs = endpoint.inherited.front().get();
    auto child = std::make_unique<ForkedChild>([&] {
      endpoint.channel.reset();  // as exec() would do
      before_attach();
      const auto channel = make_stream(theirs, theirs, "coordinator");
      body(*channel);
    });
    child->set_channel(std::move(endpoint.channel));
    return child;
  };
  return factory;
}

// Two pipes, as a participant in a shell has them.
ChannelFactory pipes() {
  ChannelFactory factory{.name = "pipes", .pair = {}, .child = {}};
  factory.pair = []() -> Ends {
    std::array<int, 2> there{}, back{};
    if (pipe2(there.data(), O_CLOEXEC) != 0 || pipe2(back.data(), O_CLOEXEC) != 0) std::abort();
    const Fd there_out(there[0]), there_in(there[1]), back_out(back[0]), back_in(back[1]);
    return {make_stream(back_out.get(), there_in.get(), "participant"),
            make_stream(there_out.get(), back_in.get(), "coordinator")};
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
        stream(),
        pipes(),
    };
#if TANDEM_WITH_DDS
    std::ranges::move(dds_factories(), std::back_inserter(all));
#endif
    return all;
  }();
  return factories;
}

}  // namespace tandem::protocol::test
