// A channel is a duplex, ordered, reliable path of frames between the coordinator and one participant.
//
// Contract, tested by one conformance suite on every implementation:
// - send(), wait() and receive() are called by one thread; the two ends are two threads or two processes.
//   peer_gone() may be called by any thread, at any time while the channel exists.
// - Frames arrive whole, once, in order. A frame may be larger than any internal buffer.
// - No call blocks past its deadline: Error{timeout} that names the peer and what was waited for.
// - A dead or closed peer is Error{peer_lost} within 1 s, in mid-frame too, and whatever the deadline;
// between
//   processes one that is stopped is within the lease.
// - Memory is taken for what has arrived, not for what a peer announces.
//   Frames that the peer sent completely before it died are delivered first.
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
  // True as soon as a frame begins to arrive (receive() will then copy and not sleep), false at the deadline,
  // which is no failure here. Lets callers tell waiting from copying, and look around while they wait.
  virtual bool wait(Deadline deadline) = 0;
  // Receives the next frame into `frame`, which is resized.
  virtual void receive(std::vector<std::byte>& frame, Deadline deadline) = 0;
  // True once the peer is known to be dead, to have closed its end, or to have given no sign of life for its
  // lease (frames of it may still wait here). This end gives signs of life from the first call of any of
  // these four on.
  virtual bool peer_gone() noexcept = 0;
  // "inproc", "shm", "dds"
  virtual const char* transport() const = 0;
  // Whom this end talks to, for messages: "mbd_server (pid 1234)"; with the pid once the peer has attached.
  virtual const std::string& peer() const = 0;
};

}  // namespace tandem::protocol
