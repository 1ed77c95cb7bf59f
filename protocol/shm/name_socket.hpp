// How two processes of one user connect on a host: by an inherited pair of sockets, or by an abstract name,
// which exists in no file system and ends with its process. Any user may use any abstract name, so that both
// ends check the other end's user by the kernel before they send or read anything.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <utility>

#include "protocol/channel.hpp"
#include "protocol/fd.hpp"

namespace tandem::protocol::shm {

std::pair<Fd, Fd> socket_pair();

// The process at the other end of a connected Unix socket, as the kernel reports it.
struct PeerIdentity {
  pid_t pid = 0;  // 0 where it is in another pid namespace
  uid_t uid = 0;
};
PeerIdentity identity_of(const Fd& socket);
// "user 65534 (pid 4711)"
std::string text(const PeerIdentity& peer);

// True once `fd` can be read, false at the deadline.
bool readable(const Fd& fd, Deadline deadline);

// The end that listens under a name.
class NameListener {
 public:
  // Throws Error{usage} if the name is invalid, is taken by a server of this user, or is held by another
  // user.
  explicit NameListener(const std::string& name);
  // Returns the next connection from a process of this user. Connections of other users are closed unread
  // and logged. Throws Error{timeout} at the deadline.
  Fd accept(Deadline deadline);

 private:
  void refuse(const PeerIdentity& stranger);

  std::string name_;
  Fd socket_;
  std::uint64_t strangers_ = 0;
};

// Connects to a name; the two ends may be started in any order. Throws Error{protocol} if another user holds
// it, Error{timeout} if nobody listens there until the deadline. `idle`, where there is one, is called during
// the wait.
Fd connect_to(const std::string& name, const std::string& peer, Deadline deadline,
              const std::function<void()>& idle);

}  // namespace tandem::protocol::shm
