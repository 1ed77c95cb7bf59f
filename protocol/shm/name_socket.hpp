// How two processes of one user meet on a host: an inherited pair of sockets, or an abstract name, which no
// file system holds and which goes with its process. Any user may use any abstract name, so both ends ask the
// kernel whose the other end is before they give or read anything.
#pragma once

#include <sys/types.h>

#include <string>
#include <utility>

#include "protocol/channel.hpp"
#include "protocol/fd.hpp"

namespace tandem::protocol::shm {

std::pair<Fd, Fd> socket_pair();

// Whom the kernel knows at the other end of a connected Unix socket: the process that connected or listened.
struct PeerIdentity {
  pid_t pid = 0;  // 0 where it lives in another pid namespace
  uid_t uid = 0;
};
PeerIdentity identity_of(const Fd& socket);
// "user 65534 (pid 4711)"
std::string text(const PeerIdentity& peer);

// True once `fd` can be read, false at the deadline.
bool readable(const Fd& fd, Deadline deadline);

// The end that waits under a name.
class NameListener {
 public:
  // Error{usage} if the name is no name, is taken by a server of this user, or is held by another user.
  explicit NameListener(const std::string& name);
  // The next connection of a process of this user. Those of others are closed unread, and the log says whose
  // they were. Error{timeout} at the deadline.
  Fd accept(Deadline deadline);

 private:
  void refuse(const PeerIdentity& stranger);

  std::string name_;
  Fd socket_;
  std::uint64_t strangers_ = 0;
};

// The end that comes to a name, in whichever order the two are started. Error{protocol} if another user holds
// it, Error{timeout} if nobody came to wait there.
Fd connect_to(const std::string& name, const std::string& peer, Deadline deadline);

}  // namespace tandem::protocol::shm
