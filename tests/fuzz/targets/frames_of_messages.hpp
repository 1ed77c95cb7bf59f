// One valid frame for each message of the protocol.
#pragma once

#include "protocol/codec.hpp"

namespace tandem::fuzz {

std::vector<protocol::Bytes> frames_of_messages();

}  // namespace tandem::fuzz
