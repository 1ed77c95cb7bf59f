#include "protocol/shm/peer_process.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <thread>

#include "common/error.hpp"

namespace tandem::protocol::shm {
namespace {

using namespace std::chrono_literals;

[[noreturn]] void fail(const std::string& what) {
  throw Error(ErrorCode::resource, what + ": " + std::strerror(errno));
}

void ask_for_credentials(const Fd& socket) {
  const int on = 1;
  if (setsockopt(socket.get(), SOL_SOCKET, SO_PASSCRED, &on, sizeof on) != 0)
    fail("a socket cannot be asked for its peer");
}

struct Address {
  sockaddr_un address{};
  socklen_t size = 0;
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
};

// The abstract namespace belongs to all users: the user id keeps names apart, and meet() keeps strangers out.
Address abstract_address(const std::string& name) {
  const bool plain = !name.empty() && name.size() <= 64 && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) || c == '-' || c == '_' || c == '.';
  });
  if (!plain)
    throw Error(ErrorCode::usage, "\"" + name + "\" is no name for a channel", "--shm",
                "use 1 to 64 letters, digits, '-', '_' and '.'");
  const std::string full = "tandem/" + std::to_string(geteuid()) + "/" + name;
  Address a;
  a.address.sun_family = AF_UNIX;
  std::memcpy(a.address.sun_path + 1, full.data(), full.size());  // the leading zero makes it abstract
  a.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + full.size());
  return a;
}

int milliseconds_until(Deadline deadline) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::clamp<long>(left, 0, 1'000'000'000));
}

bool readable(int fd, int timeout_ms) {
  pollfd p{fd, POLLIN, 0};
  int n = 0;
  do n = poll(&p, 1, timeout_ms);
  while (n < 0 && errno == EINTR);
  return n > 0;
}

}  // namespace

std::pair<Fd, Fd> socket_pair() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) fail("no pair of sockets");
  return {Fd(ends[0]), Fd(ends[1])};
}

Fd accept_one(const std::string& name, Deadline deadline) {
  const Address address = abstract_address(name);
  const Fd listener(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!listener) fail("no socket");
  if (bind(listener.get(), address.get(), address.size) != 0) {
    if (errno == EADDRINUSE)
      throw Error(ErrorCode::usage, "another server already waits under the name \"" + name + "\"", "--shm",
                  "choose another name, or end that server");
    fail("the name \"" + name + "\" cannot be used");
  }
  if (listen(listener.get(), 1) != 0) fail("the name \"" + name + "\" cannot be listened to");
  if (!readable(listener.get(), milliseconds_until(deadline)))
    throw Error(ErrorCode::timeout, "no coordinator came to the name \"" + name + "\"", "--shm",
                "start the coordinator with this name");
  Fd connection(accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC));
  if (!connection) fail("a coordinator came to the name \"" + name + "\", but was not accepted");
  return connection;
}

Fd connect_to(const std::string& name, const std::string& peer, Deadline deadline) {
  const Address address = abstract_address(name);
  while (true) {
    Fd connection(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (!connection) fail("no socket");
    if (connect(connection.get(), address.get(), address.size) == 0) return connection;
    if (errno != ECONNREFUSED && errno != EINTR && errno != EAGAIN)
      fail("the name \"" + name + "\" cannot be reached");
    if (Clock::now() >= deadline)
      throw Error(ErrorCode::timeout, "no " + peer + " waits under the name \"" + name + "\"", {},
                  "start " + peer + " --shm " + name + " on this host, as the same user");
    std::this_thread::sleep_for(20ms);  // the order in which the two are started does not matter
  }
}

void PeerProcess::give_memory(const Fd& memory) {
  ask_for_credentials(socket_);  // before the participant can speak
  char byte = 'm';
  iovec data{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> buffer{};
  msghdr message{};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = buffer.data();
  message.msg_controllen = buffer.size();
  cmsghdr* rights = CMSG_FIRSTHDR(&message);
  rights->cmsg_level = SOL_SOCKET;
  rights->cmsg_type = SCM_RIGHTS;
  rights->cmsg_len = CMSG_LEN(sizeof(int));
  const int fd = memory.get();
  std::memcpy(CMSG_DATA(rights), &fd, sizeof fd);
  if (sendmsg(socket_.get(), &message, MSG_NOSIGNAL) != 1)
    fail("the shared memory cannot be handed to " + name_);
}

Fd PeerProcess::take_memory(Deadline deadline) {
  if (!readable(socket_.get(), milliseconds_until(deadline)))
    throw Error(ErrorCode::timeout, name_ + " handed over no shared memory");
  char byte = 0;
  iovec data{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> buffer{};
  msghdr message{};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = buffer.data();
  message.msg_controllen = buffer.size();
  const ssize_t n = recvmsg(socket_.get(), &message, MSG_CMSG_CLOEXEC);
  if (n < 0 && errno == ENOTSOCK)
    throw Error(ErrorCode::usage, "the descriptor is no socket of a coordinator", "--shm",
                "fd:N is for servers that tandem starts; give a name");
  if (n <= 0) throw Error(ErrorCode::peer_lost, name_ + " died before it handed over the shared memory");
  const cmsghdr* rights = CMSG_FIRSTHDR(&message);
  if (!rights || rights->cmsg_type != SCM_RIGHTS || rights->cmsg_len != CMSG_LEN(sizeof(int)))
    throw Error(ErrorCode::protocol, name_ + " handed over no shared memory");
  int fd = -1;
  std::memcpy(&fd, CMSG_DATA(rights), sizeof fd);
  Fd memory(fd);

  ucred who{};
  socklen_t size = sizeof who;
  if (getsockopt(socket_.get(), SOL_SOCKET, SO_PEERCRED, &who, &size) != 0)
    fail("the coordinator is unknown");
  meet(who.pid, who.uid);
  if (::send(socket_.get(), &byte, 1, MSG_NOSIGNAL) != 1) throw lost("");  // the kernel adds our pid
  return memory;
}

void PeerProcess::meet(pid_t pid, uid_t uid) {
  attached_ = true;
  if (uid != geteuid())
    throw Error(
        ErrorCode::protocol,
        name_ + " runs as user " + std::to_string(uid) + ", this process as " + std::to_string(geteuid()), {},
        "run both as the same user");
  if (pid <= 0) return;  // in another pid namespace: the socket alone must do
  name_ += " (pid " + std::to_string(pid) + ")";
  pid_ = Fd(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
  if (pid_)
    pid_fd_ = pid_.get();
  else if (errno == ESRCH)
    gone_ = reaped_ = true;  // it died after it had written to us
}

bool PeerProcess::gone() noexcept {
  if (gone_) return true;
  std::array<pollfd, 2> p{{{socket_.get(), POLLRDHUP, 0}, {pid_fd_, POLLIN, 0}}};  // poll skips -1
  if (poll(p.data(), p.size(), 0) > 0 && ((p[0].revents & (POLLRDHUP | POLLHUP | POLLERR)) || p[1].revents))
    gone_ = true;
  return gone_;
}

bool PeerProcess::look() {
  if (!attached_ && readable(socket_.get(), 0)) {
    char byte = 0;
    iovec data{&byte, 1};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(ucred))> buffer{};
    msghdr message{};
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    message.msg_control = buffer.data();
    message.msg_controllen = buffer.size();
    if (recvmsg(socket_.get(), &message, MSG_DONTWAIT) == 1) {
      const cmsghdr* credentials = CMSG_FIRSTHDR(&message);
      if (credentials && credentials->cmsg_type == SCM_CREDENTIALS) {
        ucred who{};
        std::memcpy(&who, CMSG_DATA(credentials), sizeof who);
        meet(who.pid, who.uid);
      }
    }
  }
  return gone();
}

Error PeerProcess::lost(const char* in_the_middle) const {
  if (!attached_) return Error(ErrorCode::peer_lost, name_ + " died before it attached");
  // A dying process closes its sockets a little before it counts as dead.
  const int pid = pid_fd_;
  const bool dead = reaped_ || (pid >= 0 && readable(pid, 100));
  const char* how = dead ? " died" : pid < 0 ? " is gone" : " closed its end";
  return Error(ErrorCode::peer_lost, name_ + how + in_the_middle);
}

}  // namespace tandem::protocol::shm
