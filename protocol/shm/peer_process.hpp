// The socket between two processes, over which the memory is handed over and each notices the other's end. It
// carries nothing else. The kernel closes it when a process ends, however it ends; the pidfd says the same of
// a process that left copies of the socket in children. Both work for zombies; the socket also across pid
// namespaces.
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

  // Participant: takes the memory from the coordinator, and says that it has done so. Nothing is read before
  // the kernel has said that the coordinator is of this user.
  Fd take_memory(Deadline deadline);
  // Coordinator: gives the memory.
  void give_memory(const Fd& memory);
  // Coordinator: waits until the participant has said that it has taken the memory, and the kernel that it is
  // of this user.
  void await_attach(Deadline deadline);

  // Any thread. Whether the peer has ended or closed its end.
  bool gone() noexcept;
  // The channel's thread: gone(), and takes note of a peer that has just attached.
  bool look();
  // Whether both ends know of each other. The channel's thread.
  bool attached() const { return attached_; }
  // One sentence on how the peer was lost.
  Error lost(const char* in_the_middle) const;
  // "mbd_server", from attach on "mbd_server (pid 1234)".
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
