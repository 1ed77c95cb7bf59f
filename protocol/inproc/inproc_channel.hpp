// Channel between two threads of one process: for tests and for embedding.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "protocol/channel.hpp"
#include "protocol/waiting.hpp"

namespace tandem::protocol {

// first: the coordinator's end, whose peer is named `participant`; second: the participant's end.
// Destroying one end closes it for the other.
std::pair<std::unique_ptr<Channel>, std::unique_ptr<Channel>> create_inproc(
    const std::string& participant, WaitPolicy wait = WaitPolicy::adaptive);

}  // namespace tandem::protocol
