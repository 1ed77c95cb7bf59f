// Channel over shared memory, for processes of one host and one user. docs/adr/0002-shared-memory.md explains
// why the memory has no name: nothing is left behind, whichever process is killed.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "protocol/channel.hpp"
#include "protocol/endpoint.hpp"
#include "protocol/waiting.hpp"

namespace tandem::protocol {

inline constexpr std::chrono::milliseconds default_shm_lease{5000};

struct ShmOptions {
  std::size_t ring_bytes = std::size_t{1}
                           << 20;  // per direction, a power of two; larger frames stream through
  WaitPolicy wait = WaitPolicy::adaptive;
  // Silence after which a peer is lost, for both ends; 0: no limit. A dead peer is detected at once, so that
  // this applies to one that is stopped, and may be longer than over a network.
  std::chrono::milliseconds lease = default_shm_lease;
  // Called about every 20 ms while connect_shm() waits for the server; what it throws ends the wait.
  std::function<void()> idle = {};
};

// Coordinator's end of a server that the coordinator starts itself; `peer` is its name in messages.
Endpoint create_shm(const std::string& peer, const ShmOptions& options = {});

// Coordinator's end of a server that the user started with `--shm NAME`; waits for it until the deadline.
// Throws Error{protocol} if another user holds the name; nothing is sent to that process.
std::unique_ptr<Channel> connect_shm(const std::string& name, const std::string& peer, Deadline deadline,
                                     const ShmOptions& options = {});

// Participant's end. `address` is the argument of --shm: "fd:N" from a coordinator that started this process,
// or a name under which this process then waits for a coordinator until the deadline; other peers are
// ignored.
std::unique_ptr<Channel> attach_shm(const std::string& address, Deadline deadline,
                                    WaitPolicy wait = WaitPolicy::adaptive);

// Whether `address` shows that a coordinator started this process.
bool started_by_coordinator(const std::string& address);

}  // namespace tandem::protocol
