#include "protocol/shm/name_socket.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <thread>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/utf8.hpp"

namespace tandem::protocol::shm {
namespace {

using namespace std::chrono_literals;

[[noreturn]] void fail_to_meet(const std::string& what) {
  throw Error(ErrorCode::resource, what + ": " + std::strerror(errno));
}

struct NameAddress {
  sockaddr_un address{};
  socklen_t size = 0;
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
};

// The user id separates the names of different users; identity_of() excludes strangers.
NameAddress abstract_address(const std::string& name) {
  const bool plain = !name.empty() && name.size() <= 64 && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) || c == '-' || c == '_' || c == '.';
  });
  if (!plain)
    throw Error(ErrorCode::usage, "\"" + shortened(name) + "\" is no name for a channel", "--shm",
                "use 1 to 64 letters, digits, '-', '_' and '.'");
  const std::string full = "tandem/" + std::to_string(geteuid()) + "/" + name;
  NameAddress a;
  a.address.sun_family = AF_UNIX;
  // The leading zero makes the address abstract.
  std::memcpy(a.address.sun_path + 1, full.data(), full.size());
  a.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + full.size());
  return a;
}

Fd new_socket(int flags = 0) {
  Fd made(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | flags, 0));
  if (!made) fail_to_meet("no socket");
  return made;
}

// Non-blocking, because a process that holds a name and accepts no connections would block this one. Returns
// 0 or an error number.
int connect_now(const Fd& socket, const NameAddress& address) {
  if (connect(socket.get(), address.get(), address.size) != 0) return errno;
  return fcntl(socket.get(), F_SETFL, 0) == 0 ? 0 : errno;
}

Error held_by_another(const std::string& name, const PeerIdentity& holder) {
  return Error(ErrorCode::protocol,
               "the name \"" + name + "\" is held by " + text(holder) + ", not by a process of this user (" +
                   std::to_string(geteuid()) + ")",
               "--shm", "nothing was given to it; choose another name, one that cannot be guessed");
}

// The error for a taken name: with the process that waits under it, or without one where its holder does not
// listen (yet).
Error taken(const std::string& name, const NameAddress& address) {
  const Fd probe = new_socket(SOCK_NONBLOCK);
  if (connect_now(probe, address) == 0)
    if (const PeerIdentity holder = identity_of(probe); holder.uid != geteuid())
      return held_by_another(name, holder);
  return Error(ErrorCode::usage, "another server already waits under the name \"" + name + "\"", "--shm",
               "choose another name, or end that server");
}

}  // namespace

std::pair<Fd, Fd> socket_pair() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    fail_to_meet("no pair of sockets");
  return {Fd(ends[0]), Fd(ends[1])};
}

PeerIdentity identity_of(const Fd& socket) {
  ucred who{};
  socklen_t size = sizeof who;
  if (getsockopt(socket.get(), SOL_SOCKET, SO_PEERCRED, &who, &size) != 0)
    fail_to_meet("the user at the other end of a socket is unknown");
  return {who.pid, who.uid};
}

std::string text(const PeerIdentity& peer) {
  return "user " + std::to_string(peer.uid) + (peer.pid > 0 ? " (pid " + std::to_string(peer.pid) + ")" : "");
}

bool readable(const Fd& fd, Deadline deadline) {
  pollfd p{fd.get(), POLLIN, 0};
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    const int n = poll(&p, 1, static_cast<int>(std::clamp<long>(left, 0, 1'000'000'000)));
    if (n > 0) return true;
    if (n == 0 && Clock::now() >= deadline) return false;
  }
}

NameListener::NameListener(const std::string& name) : name_(name) {
  const NameAddress address = abstract_address(name);
  socket_ = new_socket();
  if (bind(socket_.get(), address.get(), address.size) != 0) {
    if (errno == EADDRINUSE) throw taken(name, address);
    fail_to_meet("the name \"" + name + "\" cannot be used");
  }
  // Allows for a coordinator besides many strangers.
  if (listen(socket_.get(), 64) != 0) fail_to_meet("the name \"" + name + "\" cannot be listened to");
}

Fd NameListener::accept(Deadline deadline) {
  for (;;) {
    if (!readable(socket_, deadline))
      throw Error(ErrorCode::timeout, "no coordinator came to the name \"" + name_ + "\"", "--shm",
                  "start the coordinator with this name");
    Fd connection(accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (!connection) {
      // A connection that was closed again is ignored.
      if (errno == ECONNABORTED || errno == EINTR) continue;
      fail_to_meet("a coordinator came to the name \"" + name_ + "\", but was not accepted");
    }
    const PeerIdentity peer = identity_of(connection);
    if (peer.uid == geteuid()) return connection;
    refuse(peer);
  }
}

// One line for each power of two, so that a persistent stranger does not fill the disk.
void NameListener::refuse(const PeerIdentity& stranger) {
  if (!std::has_single_bit(++strangers_)) return;
  log::warn(
      "refused {} at the name {}: only processes of user {} may come here ({} refused so far); waiting on",
      text(stranger), name_, geteuid(), strangers_);
}

Fd connect_to(const std::string& name, const std::string& peer, Deadline deadline,
              const std::function<void()>& idle) {
  const NameAddress address = abstract_address(name);
  for (;;) {
    Fd connection = new_socket(SOCK_NONBLOCK);
    const int problem = connect_now(connection, address);
    if (problem == 0) {
      const PeerIdentity holder = identity_of(connection);
      if (holder.uid != geteuid()) throw held_by_another(name, holder);
      return connection;
    }
    if (problem != ECONNREFUSED && problem != EINTR && problem != EAGAIN) {
      errno = problem;
      fail_to_meet("the name \"" + name + "\" cannot be reached");
    }
    if (Clock::now() >= deadline && problem == EAGAIN)
      throw Error(ErrorCode::timeout, "who waits under the name \"" + name + "\" takes no connections", {},
                  "choose another name, one that cannot be guessed");
    if (Clock::now() >= deadline)
      throw Error(ErrorCode::timeout, "no " + peer + " waits under the name \"" + name + "\"", {},
                  "start " + peer + " --shm " + name + " on this host, as the same user");
    if (idle) idle();
    std::this_thread::sleep_for(20ms);  // the two may be started in any order
  }
}

}  // namespace tandem::protocol::shm
