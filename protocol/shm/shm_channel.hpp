// Channel over shared memory, for processes of one host and one user. docs/adr/0002-shared-memory.md says why
// the memory has no name: nothing can be left behind, whoever is killed and whenever.
#pragma once

#include <chrono>
#include <cstddef>
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
  // A peer that gives no sign of life for so long is lost; 0: however long. It holds for both ends. A dead
  // peer shows at once, so this is about one that is stopped, and may be longer than over a network.
  std::chrono::milliseconds lease = default_shm_lease;
};

// Coordinator's end of a server that the coordinator starts itself; `peer` names the server in messages.
Endpoint create_shm(const std::string& peer, const ShmOptions& options = {});

// Coordinator's end of a server that was started by hand with `--shm NAME`; waits for it until the deadline.
// Error{protocol} if another user holds the name: nothing is given to it.
std::unique_ptr<Channel> connect_shm(const std::string& name, const std::string& peer, Deadline deadline,
                                     const ShmOptions& options = {});

// Participant's end. `address` is what stood after --shm: "fd:N" from a coordinator that started this
// process, or a name under which this process then waits for a coordinator until the deadline, whoever else
// comes there.
std::unique_ptr<Channel> attach_shm(const std::string& address, Deadline deadline,
                                    WaitPolicy wait = WaitPolicy::adaptive);

// Whether `address` says that a coordinator started this process.
bool started_by_coordinator(const std::string& address);

}  // namespace tandem::protocol
