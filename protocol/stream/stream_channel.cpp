#include "protocol/stream/stream_channel.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>

#include "common/error.hpp"
#include "common/utf8.hpp"
#include "protocol/fd.hpp"
#include "protocol/frame.hpp"
#include "protocol/latch.hpp"

namespace tandem::protocol {
namespace {

// Memory that is allocated for a frame before its first byte has arrived [bytes].
constexpr std::size_t stream_trusted_size = std::size_t{1} << 20;

Error no_stream(const std::string& problem) {
  return Error(ErrorCode::resource, problem + ": " + std::strerror(errno), "--stream");
}

class StreamChannel final : public Channel {
 public:
  StreamChannel(Fd in, Fd out, std::string peer, StreamContent content)
      : in_(std::move(in)), out_(std::move(out)), peer_(std::move(peer)), content_(content) {
    for (const Fd* fd : {&in_, &out_}) {
      const int flags = fcntl(fd->get(), F_GETFL);
      if (flags < 0 || fcntl(fd->get(), F_SETFL, flags | O_NONBLOCK) != 0)
        throw no_stream("descriptor " + std::to_string(fd->get()) + " cannot be used");
    }
  }

  void send(std::span<const std::span<const std::byte>> parts, Deadline deadline) override {
    latch_([&] {
      std::uint64_t size = 0;
      for (const auto& part : parts) size += part.size();
      pieces_.assign(1, as_piece(std::as_bytes(std::span(&size, 1))));
      for (const auto& part : parts)
        if (!part.empty()) pieces_.push_back(as_piece(part));
      write_pieces(deadline);
    });
  }

  bool wait(Deadline deadline) override {
    return latch_([&] {
      if (!await(in_, POLLIN, deadline)) return false;
      expect_bytes();
      return true;
    });
  }

  void receive(std::vector<std::byte>& frame, Deadline deadline) override {
    latch_([&] {
      std::uint64_t size = 0;
      read_all(std::as_writable_bytes(std::span(&size, 1)), "sent no message", "", deadline);
      if (size > max_payload + sizeof(FrameHeader)) throw no_frame(size, {});
      std::uint32_t magic = 0;
      const auto first = std::as_writable_bytes(std::span(&magic, 1));
      const std::size_t read_ahead = content_ == StreamContent::frames ? sizeof magic : 0;
      read_all(first.first(read_ahead), "sent only a part of a message", " in the middle of a message",
               deadline);
      if (read_ahead > 0 && (magic != frame_magic || size < sizeof(FrameHeader))) throw no_frame(size, first);
      // Memory is allocated only as the bytes of this frame arrive, whatever size is announced.
      for (std::size_t got = read_ahead; got < size || frame.size() != size;) {
        frame.resize(std::min<std::size_t>(size, std::max({frame.capacity(), 2 * got, stream_trusted_size})));
        if (read_ahead > 0) std::memcpy(frame.data(), &magic, read_ahead);
        read_all(std::span(frame).subspan(got), "sent only a part of a message",
                 " in the middle of a message", deadline);
        got = frame.size();
      }
    });
  }

  bool peer_gone() noexcept override {
    if (gone_) return true;
    pollfd watched{in_.get(), POLLRDHUP, 0};
    if (poll(&watched, 1, 0) > 0 && (watched.revents & (POLLHUP | POLLRDHUP | POLLERR | POLLNVAL)))
      gone_ = true;
    return gone_;
  }

  const char* transport() const override { return "stream"; }
  const std::string& peer() const override { return peer_; }

 private:
  static iovec as_piece(std::span<const std::byte> bytes) {
    return {const_cast<std::byte*>(bytes.data()), bytes.size()};
  }

  // The first bytes of a frame are its size and "TNDM". A program that prints puts text there.
  Error no_frame(std::uint64_t size, std::span<const std::byte> after) const {
    std::string bytes(reinterpret_cast<const char*>(&size), sizeof size);
    bytes.append(reinterpret_cast<const char*>(after.data()), after.size());
    std::size_t printed = 0;
    const auto is_text = [](char c) { return (c >= ' ' && c <= '~') || c == '\n' || c == '\r' || c == '\t'; };
    while (printed < bytes.size() && is_text(bytes[printed])) ++printed;
    if (printed > 0)
      return Error(ErrorCode::protocol,
                   peer_ + " wrote text to the channel, which is its standard output: \"" +
                       printable_line(bytes.substr(0, printed)) + "\"",
                   {}, "print to standard error, or after the kit's main function has been called");
    return Error(ErrorCode::protocol,
                 peer_ + " announced a frame of " + std::to_string(size) + " bytes that is none", {},
                 "each frame on a stream is its size as 8 bytes, little-endian, and then the frame");
  }

  Error lost(const char* in_the_middle) {
    gone_ = true;
    return Error(ErrorCode::peer_lost, peer_ + " closed its end" + in_the_middle);
  }

  // False at the deadline. A hang-up counts as an event: the next read or write reports it.
  static bool await(const Fd& fd, short event, Deadline deadline) {
    for (;;) {
      pollfd watched{fd.get(), event, 0};
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
      const int ready = poll(&watched, 1, static_cast<int>(std::clamp<long>(left, 0, 1'000'000'000)));
      if (ready > 0) return true;
      if (ready < 0 && errno != EINTR) throw no_stream("waiting failed");
      if (Clock::now() >= deadline) return false;
    }
  }

  // Throws where the peer has gone and no byte is left. A socket can be read without taking bytes out; on a
  // pipe a hang-up without data is the end.
  void expect_bytes() {
    std::byte byte{};
    const ssize_t n = recv(in_.get(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    if (n == 0 || (n < 0 && errno == ECONNRESET)) throw lost("");
    if (n >= 0 || errno != ENOTSOCK) return;
    pollfd watched{in_.get(), POLLIN, 0};
    if (poll(&watched, 1, 0) > 0 && !(watched.revents & POLLIN)) throw lost("");
  }

  void read_all(std::span<std::byte> bytes, const char* late, const char* in_the_middle, Deadline deadline) {
    while (!bytes.empty()) {
      const ssize_t n = read(in_.get(), bytes.data(), bytes.size());
      if (n > 0) {
        bytes = bytes.subspan(static_cast<std::size_t>(n));
      } else if (n == 0 || errno == ECONNRESET) {
        throw lost(in_the_middle);
      } else if (errno == EAGAIN) {
        if (!await(in_, POLLIN, deadline)) throw Error(ErrorCode::timeout, peer_ + " " + late);
      } else if (errno != EINTR) {
        throw no_stream("reading from " + peer_ + " failed");
      }
    }
  }

  void write_pieces(Deadline deadline) {
    for (std::size_t first = 0; first < pieces_.size();) {
      const ssize_t n = write_some(first);
      if (n < 0) {
        if (errno == EPIPE || errno == ECONNRESET) throw lost(" before it took a message");
        if (errno == EAGAIN) {
          if (!await(out_, POLLOUT, deadline)) throw Error(ErrorCode::timeout, peer_ + " took no message");
        } else if (errno != EINTR) {
          throw no_stream("writing to " + peer_ + " failed");
        }
        continue;
      }
      for (auto left = static_cast<std::size_t>(n); left > 0;) {
        const std::size_t taken = std::min(left, pieces_[first].iov_len);
        pieces_[first].iov_base = static_cast<std::byte*>(pieces_[first].iov_base) + taken;
        pieces_[first].iov_len -= taken;
        left -= taken;
        if (pieces_[first].iov_len == 0) ++first;
      }
    }
  }

  // Without SIGPIPE where that can be had; a participant on pipes ignores the signal
  // (common/stream_signals.hpp).
  ssize_t write_some(std::size_t first) {
    msghdr message{};
    message.msg_iov = &pieces_[first];
    message.msg_iovlen = pieces_.size() - first;
    const ssize_t n = sendmsg(out_.get(), &message, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n >= 0 || errno != ENOTSOCK) return n;
    return writev(out_.get(), &pieces_[first], static_cast<int>(pieces_.size() - first));
  }

  Fd in_, out_;
  std::string peer_;
  StreamContent content_;
  std::vector<iovec> pieces_;
  std::atomic<bool> gone_ = false;
  FailureLatch latch_;
};

Fd copy_of(int fd) {
  Fd copy(fcntl(fd, F_DUPFD_CLOEXEC, 3));
  if (!copy) throw no_stream("descriptor " + std::to_string(fd) + " is not open");
  return copy;
}

}  // namespace

Endpoint create_stream(const std::string& peer, StreamContent content) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw no_stream("no pair of sockets");
  Fd ours(ends[0]), theirs(ends[1]);
  Endpoint endpoint;
  Fd in = copy_of(ours.get());
  endpoint.channel = std::make_unique<StreamChannel>(std::move(in), std::move(ours), peer, content);
  endpoint.server_arguments = {"--stream", "-"};
  endpoint.inherited.push_back(std::move(theirs));
  return endpoint;
}

std::unique_ptr<Channel> make_stream(int in, int out, const std::string& peer) {
  return std::make_unique<StreamChannel>(copy_of(in), copy_of(out), peer, StreamContent::any);
}

std::unique_ptr<Channel> attach_stream(const std::string& address) {
  if (address != "-")
    throw Error(ErrorCode::usage, "\"" + address + "\" is no stream", "--stream",
                "write \"-\" for standard input and output");
  auto channel = make_stream(STDIN_FILENO, STDOUT_FILENO, "coordinator");
  // A program or library that prints must not write into the channel.
  const Fd nothing(open("/dev/null", O_RDONLY | O_CLOEXEC));
  if (!nothing || dup2(nothing.get(), STDIN_FILENO) < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
    throw no_stream("standard input and output cannot be separated from the channel");
  return channel;
}

}  // namespace tandem::protocol
