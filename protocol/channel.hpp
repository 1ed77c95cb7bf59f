// A channel is a duplex, ordered, reliable path of frames between the coordinator and one participant.
//
// Contract, tested by one conformance suite on every implementation:
// - send(), wait() and receive() are called by one thread; the two ends are two threads or two processes.
// peer_gone() may be called by any thread, at any time while the channel exists.
// - Frames arrive whole, once, in order. A frame may be larger than any internal buffer.
// - No call blocks past its deadline: it throws Error{timeout} that names the peer and the awaited message.
// - A dead or closed peer is reported as Error{peer_lost} within 1 s, also in mid-frame and whatever the
// deadline; between processes, a stopped peer within the lease.
// - Memory is allocated for bytes that have arrived, not for a size that a peer announces.
// - Frames that the peer sent completely before it died are delivered first.
// - A failure is latched: every later call throws the same Error.
// - The receive buffer belongs to the caller and is reused, so that a steady exchange does not allocate.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tandem::protocol {

using Clock = std::chrono::steady_clock;
using Deadline = Clock::time_point;

class Channel {
 public:
  virtual ~Channel() = default;

  // Sends one frame (header and payload as one sequence of parts, so that callers need not copy).
  virtual void send(std::span<const std::span<const std::byte>> parts, Deadline deadline) = 0;
  // Returns true as soon as a frame begins to arrive (receive() will then copy and not sleep), false at the
  // deadline, which is not a failure here. It lets callers distinguish waiting from copying, and do other
  // checks while they wait.
  virtual bool wait(Deadline deadline) = 0;
  // Receives the next frame into `frame`, which is resized.
  virtual void receive(std::vector<std::byte>& frame, Deadline deadline) = 0;
  // True once the peer is known to be dead, to have closed its end, or to have given no sign of life for
  // its lease (its frames may still wait here). This end gives signs of life from the first call of any of
  // these four functions.
  virtual bool peer_gone() noexcept = 0;
  // "inproc", "shm", "dds"
  virtual const char* transport() const = 0;
  // Name of the other end for messages: "mbd_server (pid 1234)"; with the pid once the peer has attached.
  virtual const std::string& peer() const = 0;
};

}  // namespace tandem::protocol
