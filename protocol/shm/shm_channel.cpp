#include "protocol/shm/shm_channel.hpp"

#include <fcntl.h>

#include <charconv>

#include "common/error.hpp"
#include "protocol/latch.hpp"
#include "protocol/shm/peer_process.hpp"
#include "protocol/shm/ring.hpp"
#include "protocol/shm/segment.hpp"

namespace tandem::protocol {
namespace {

enum class End { coordinator, participant };

class ShmChannel : public Channel {
 public:
  ShmChannel(std::unique_ptr<shm::PeerProcess> process, const Fd& memory, End end, WaitPolicy policy)
      : process_(std::move(process)),
        segment_(memory),
        out_(end == End::coordinator ? segment_.head().to_participant : segment_.head().to_coordinator,
             segment_.ring(end == End::coordinator ? 0 : 1), segment_.head().ring_bytes, policy, looker()),
        in_(end == End::coordinator ? segment_.head().to_coordinator : segment_.head().to_participant,
            segment_.ring(end == End::coordinator ? 1 : 0), segment_.head().ring_bytes, policy, looker()) {}

  void send(std::span<const std::span<const std::byte>> parts, Deadline deadline) override {
    latch_([&] {
      look_sometimes();
      expect_ready(out_.write(parts, deadline), " before it took a message", "took no message");
    });
  }

  bool wait(Deadline deadline) override {
    return latch_([&] {
      const auto outcome = in_.wait(deadline);
      if (outcome == shm::Waiter::Outcome::gone) throw process_->lost("");
      if (!met_) met_ = (process_->look(), true);  // who says hello is known by name from now on
      return outcome == shm::Waiter::Outcome::ready;
    });
  }

  void receive(std::vector<std::byte>& frame, Deadline deadline) override {
    latch_([&] {
      const auto outcome = in_.wait(deadline);
      expect_ready(outcome, "", "sent no message");
      expect_ready(in_.read(frame, deadline), " in the middle of a message", "sent only a part of a message");
    });
  }

  bool peer_gone() noexcept override { return process_->gone(); }
  const char* transport() const override { return "shm"; }
  const std::string& peer() const override { return process_->name(); }

 private:
  std::function<bool()> looker() {
    return [process = process_.get()] { return process->look(); };
  }

  // There may be room for many messages to a peer that is long dead; a look costs a system call.
  void look_sometimes() {
    const Clock::time_point now = Clock::now();
    if (now - looked_ < std::chrono::milliseconds(20)) return;
    looked_ = now;
    if (process_->look()) throw process_->lost("");
  }

  void expect_ready(shm::Waiter::Outcome outcome, const char* in_the_middle, const char* late) const {
    if (outcome == shm::Waiter::Outcome::gone) throw process_->lost(in_the_middle);
    if (outcome == shm::Waiter::Outcome::deadline) throw Error(ErrorCode::timeout, peer() + " " + late);
  }

  std::unique_ptr<shm::PeerProcess> process_;
  shm::Segment segment_;
  shm::RingWriter out_;
  shm::RingReader in_;
  FailureLatch latch_;
  Clock::time_point looked_{};
  bool met_ = false;
};

std::unique_ptr<Channel> coordinator_end(Fd socket, const std::string& peer, const ShmOptions& options) {
  auto process = std::make_unique<shm::PeerProcess>(std::move(socket), peer);
  const Fd memory = shm::create_memory(options.ring_bytes);
  process->give_memory(memory);
  return std::make_unique<ShmChannel>(std::move(process), memory, End::coordinator, options.wait);
}

constexpr std::string_view inherited_prefix = "fd:";

Fd inherited_socket(const std::string& address) {
  int fd = -1;
  const char* end = address.data() + address.size();
  const auto [stop, problem] = std::from_chars(address.data() + inherited_prefix.size(), end, fd);
  if (problem != std::errc{} || stop != end || fcntl(fd, F_SETFD, FD_CLOEXEC) != 0)
    throw Error(ErrorCode::usage, "\"" + address + "\" is no open descriptor", "--shm",
                "fd:N is for servers that tandem starts; give a name");
  return Fd(fd);
}

}  // namespace

Endpoint create_shm(const std::string& peer, const ShmOptions& options) {
  auto [ours, theirs] = shm::socket_pair();
  Endpoint endpoint;
  endpoint.channel = coordinator_end(std::move(ours), peer, options);
  endpoint.server_arguments = {"--shm", std::string(inherited_prefix) + std::to_string(theirs.get())};
  endpoint.inherited.push_back(std::move(theirs));
  return endpoint;
}

std::unique_ptr<Channel> connect_shm(const std::string& name, const std::string& peer, Deadline deadline,
                                     const ShmOptions& options) {
  return coordinator_end(shm::connect_to(name, peer, deadline), peer, options);
}

bool started_by_coordinator(const std::string& address) {
  return address.starts_with(inherited_prefix);
}

std::unique_ptr<Channel> attach_shm(const std::string& address, Deadline deadline, WaitPolicy wait) {
  Fd socket =
      started_by_coordinator(address) ? inherited_socket(address) : shm::accept_one(address, deadline);
  auto process = std::make_unique<shm::PeerProcess>(std::move(socket), "coordinator");
  const Fd memory = process->take_memory(deadline);
  return std::make_unique<ShmChannel>(std::move(process), memory, End::participant, wait);
}

}  // namespace tandem::protocol
