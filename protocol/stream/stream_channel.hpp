// Channel over a Unix stream socket or a pair of pipes, for participants in languages without shared memory:
// in each direction a sequence of {size u64, little-endian; frame of that size}. A peer that dies closes its
// end. A peer that is stopped is detected by the patience of the one who waits, because this channel carries
// no signs of life.
#pragma once

#include <memory>
#include <string>

#include "protocol/channel.hpp"
#include "protocol/endpoint.hpp"

namespace tandem::protocol {

enum class StreamContent {
  frames,  // what does not begin as a frame is an error at once: text that the participant prints, for
           // instance
  any,     // only the channel itself is tried
};

// Coordinator's end of a participant that the coordinator starts itself; `peer` is its name in messages. The
// participant's end is a socket, which is both its standard input and its standard output when the
// coordinator starts it with `--stream -`, the argument in the endpoint.
Endpoint create_stream(const std::string& peer, StreamContent content = StreamContent::frames);

// Participant's end. `address` is the argument of --stream: "-" for standard input and output, which from
// then on belong to the channel: what the process prints goes to standard error instead.
std::unique_ptr<Channel> attach_stream(const std::string& address);

// An end made of two open descriptors, which may be the same.
std::unique_ptr<Channel> make_stream(int in, int out, const std::string& peer);

}  // namespace tandem::protocol
