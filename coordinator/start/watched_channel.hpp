// A channel to a process that was started here: where the peer is lost, its error says how the process ended.
#pragma once

#include <memory>

#include "coordinator/start/processes.hpp"
#include "protocol/channel.hpp"

namespace tandem::launch {

// `process` must outlive the channel.
std::unique_ptr<protocol::Channel> with_ending(std::unique_ptr<protocol::Channel> channel, Process& process);

}  // namespace tandem::launch
