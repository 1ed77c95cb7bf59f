#include "protocol/shm/peer_process.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "protocol/shm/name_socket.hpp"

namespace tandem::protocol::shm {
namespace {

using namespace std::chrono_literals;

constexpr char memory_byte = 'm', attach_byte = 'a';

[[noreturn]] void fail(const std::string& what) {
  throw Error(ErrorCode::resource, what + ": " + std::strerror(errno));
}

void ask_for_credentials(const Fd& socket) {
  const int on = 1;
  if (setsockopt(socket.get(), SOL_SOCKET, SO_PASSCRED, &on, sizeof on) != 0)
    fail("a socket cannot be asked for its peer");
}

void expect_this_user(const std::string& peer, uid_t uid) {
  if (uid != geteuid())
    throw Error(
        ErrorCode::protocol,
        peer + " runs as user " + std::to_string(uid) + ", this process as " + std::to_string(geteuid()), {},
        "run both as the same user");
}

PeerIdentity identity_or_usage(const Fd& socket) {
  try {
    return identity_of(socket);
  } catch (const Error&) {
    if (errno != ENOTSOCK) throw;
    throw Error(ErrorCode::usage, "the descriptor is no socket of a coordinator", "--shm",
                "fd:N is for servers that tandem starts; give a name");
  }
}

}  // namespace

void PeerProcess::give_memory(const Fd& memory) {
  ask_for_credentials(socket_);  // before the participant can send
  char byte = memory_byte;
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
  const PeerIdentity who = identity_or_usage(socket_);
  expect_this_user(name_, who.uid);
  if (!readable(socket_, deadline)) throw Error(ErrorCode::timeout, name_ + " handed over no shared memory");
  char byte = 0;
  iovec data{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> buffer{};
  msghdr message{};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = buffer.data();
  message.msg_controllen = buffer.size();
  const ssize_t n = recvmsg(socket_.get(), &message, MSG_CMSG_CLOEXEC);
  if (n <= 0) throw Error(ErrorCode::peer_lost, name_ + " died before it handed over the shared memory");
  const cmsghdr* rights = CMSG_FIRSTHDR(&message);
  if (!rights || rights->cmsg_type != SCM_RIGHTS || rights->cmsg_len != CMSG_LEN(sizeof(int)))
    throw Error(ErrorCode::protocol, name_ + " handed over no shared memory");
  int fd = -1;
  std::memcpy(&fd, CMSG_DATA(rights), sizeof fd);
  Fd memory(fd);

  meet(who.pid, who.uid);
  // The kernel adds pid and user of this process.
  if (::send(socket_.get(), &attach_byte, 1, MSG_NOSIGNAL) != 1) throw lost("");
  return memory;
}

void PeerProcess::await_attach(Deadline deadline) {
  while (!check_peer() && !attached_)
    if (!readable(socket_, deadline))
      throw Error(ErrorCode::timeout, name_ + " took no shared memory", {},
                  "it may be stopped, or be no server of tandem");
  if (!attached_) throw lost("");
}

void PeerProcess::meet(pid_t pid, uid_t uid) {
  expect_this_user(name_, uid);
  attached_ = true;
  if (pid <= 0) return;  // in another pid namespace: only the socket is used
  name_ += " (pid " + std::to_string(pid) + ")";
  pid_ = Fd(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
  if (pid_)
    pid_fd_ = pid_.get();
  else if (errno == ESRCH)
    gone_ = reaped_ = true;  // it died after it had attached
}

bool PeerProcess::gone() noexcept {
  if (gone_) return true;
  std::array<pollfd, 2> p{{{socket_.get(), POLLRDHUP, 0}, {pid_fd_, POLLIN, 0}}};  // poll skips -1
  if (poll(p.data(), p.size(), 0) > 0 && ((p[0].revents & (POLLRDHUP | POLLHUP | POLLERR)) || p[1].revents))
    gone_ = true;
  return gone_;
}

bool PeerProcess::check_peer() {
  if (!attached_ && readable(socket_, Deadline{})) {
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
  // A dying process closes its sockets shortly before it counts as dead.
  const int pid = pid_fd_;
  const bool dead = reaped_ || (pid >= 0 && readable(pid_, Clock::now() + 100ms));
  const char* how = dead ? " died" : pid < 0 ? " is gone" : " closed its end";
  return Error(ErrorCode::peer_lost, name_ + how + in_the_middle);
}

}  // namespace tandem::protocol::shm
