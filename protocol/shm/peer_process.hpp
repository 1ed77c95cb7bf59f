// The socket between two processes. It transfers the descriptor of the memory and shows each end the death of
// the other; it carries nothing else. The kernel closes it when a process ends for any reason; the pidfd also
// detects this where the process left copies of the socket in children. Both work for zombies; the socket
// also across pid namespaces.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <string>

#include "common/error.hpp"
#include "protocol/channel.hpp"
#include "protocol/fd.hpp"

namespace tandem::protocol::shm {

class PeerProcess {
 public:
  PeerProcess(Fd socket, std::string name) : socket_(std::move(socket)), name_(std::move(name)) {}

  // Participant: receives the memory from the coordinator and confirms it. Nothing is read before the
  // kernel has reported that the coordinator belongs to this user.
  Fd take_memory(Deadline deadline);
  // Coordinator: sends the memory.
  void give_memory(const Fd& memory);
  // Coordinator: waits for the participant's confirmation, and for the kernel's report that it belongs to
  // this user.
  void await_attach(Deadline deadline);

  // Any thread. Whether the peer has ended or closed its end.
  bool gone() noexcept;
  // The channel's thread: gone(), and records that a peer has attached.
  bool check_peer();
  // The channel's thread: whether both ends know each other.
  bool attached() const { return attached_; }
  // The error that describes the loss of the peer.
  Error lost(const char* in_the_middle) const;
  // "mbd_server"; once it has attached, "mbd_server (pid 1234)".
  const std::string& name() const { return name_; }

 private:
  void meet(pid_t pid, uid_t uid);
  Fd socket_;
  std::string name_;
  bool attached_ = false, reaped_ = false;
  std::atomic<bool> gone_ = false;
  Fd pid_;                        // owner of the next
  std::atomic<int> pid_fd_ = -1;  // read by any thread
};

}  // namespace tandem::protocol::shm
