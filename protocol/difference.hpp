// The first value in which two payloads of one kind of message differ, to the bit.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "protocol/messages.hpp"

namespace tandem::protocol {

struct Difference {
  std::string place;               // "BodyMotion of body 3: end_pose.p_WB.z"
  std::string replayed, recorded;  // both values
  std::string difference;          // replayed - recorded, where both are numbers; or empty
};

// Names fields as records.def does. Compares what follows from the orders alone: of `configured` the boundary
// bodies, of `failure` code and sentence, nothing of `hello` and `report`, whose facts are about machine and
// time. Throws ProtocolError where a payload is not one of this kind.
std::optional<Difference> first_difference(Kind kind, std::span<const std::byte> replayed,
                                           std::span<const std::byte> recorded);

}  // namespace tandem::protocol
