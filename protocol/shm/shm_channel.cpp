#include "protocol/shm/shm_channel.hpp"

#include <fcntl.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <charconv>
#include <mutex>
#include <optional>

#include "common/error.hpp"
#include "common/log.hpp"
#include "protocol/latch.hpp"
#include "protocol/shm/heartbeat.hpp"
#include "protocol/shm/name_socket.hpp"
#include "protocol/shm/peer_process.hpp"
#include "protocol/shm/ring.hpp"
#include "protocol/shm/segment.hpp"

namespace tandem::protocol {
namespace {

enum class End { coordinator, participant };

class ShmChannel : public Channel {
 public:
  ShmChannel(std::unique_ptr<shm::PeerProcess> process, const Fd& memory, End end, WaitPolicy policy)
      : end_(end),
        process_(std::move(process)),
        segment_(memory),
        out_(end == End::coordinator ? segment_.head().to_participant : segment_.head().to_coordinator,
             segment_.ring(end == End::coordinator ? 0 : 1), segment_.head().ring_bytes, policy,
             peer_check()),
        in_(end == End::coordinator ? segment_.head().to_coordinator : segment_.head().to_participant,
            segment_.ring(end == End::coordinator ? 1 : 0), segment_.head().ring_bytes, policy,
            peer_check()) {
    // A participant is ready to receive; a coordinator may fork its servers first.
    if (end == End::participant) start_heartbeat();
  }

  void send(std::span<const std::span<const std::byte>> parts, Deadline deadline) override {
    start_heartbeat();
    latch_([&] {
      check_peer_sometimes();
      expect_ready(out_.write(parts, deadline), " before it took a message", "took no message");
    });
  }

  bool wait(Deadline deadline) override {
    start_heartbeat();
    return latch_([&] { return expect_attached(in_.wait(deadline)); });
  }

  void receive(std::vector<std::byte>& frame, Deadline deadline) override {
    start_heartbeat();
    latch_([&] {
      const auto outcome = in_.wait(deadline);
      expect_ready(outcome, "", "sent no message");
      expect_attached(outcome);
      expect_ready(in_.read(frame, deadline), " in the middle of a message", "sent only a part of a message");
    });
  }

  bool peer_gone() noexcept override {
    try {
      start_heartbeat();
    } catch (const std::exception&) {
      // Where no thread can be started, the next call that may fail reports it.
    }
    return process_->gone() || silent();
  }
  const char* transport() const override { return "shm"; }
  const std::string& peer() const override { return process_->name(); }

 private:
  std::function<bool()> peer_check() {
    return [this] { return process_->check_peer() || silent(); };
  }

  // Any thread. Called for each message, for which call_once would be a noticeable cost.
  void start_heartbeat() {
    if (beats_.load(std::memory_order_acquire)) return;
    std::call_once(begun_, [this] {
      shm::SegmentHead& head = segment_.head();
      const bool leads = end_ == End::coordinator;
      heartbeat_.emplace(leads ? head.coordinator_beats : head.participant_beats,
                         leads ? head.participant_beats : head.coordinator_beats,
                         std::chrono::milliseconds(head.lease));
      beats_ = true;
    });
  }
  bool silent() const noexcept { return beats_.load(std::memory_order_acquire) && heartbeat_->silent(); }

  // A peer that sends has attached before, so that the kernel has reported its user; its name is known from
  // then on.
  bool expect_attached(shm::Waiter::Outcome outcome) {
    if (outcome == shm::Waiter::Outcome::gone) throw lost("");
    if (!process_->attached()) process_->check_peer();
    if (outcome != shm::Waiter::Outcome::ready) return false;
    if (!process_->attached())
      throw Error(ErrorCode::protocol, peer() + " spoke before it attached", {},
                  "start both sides from the same release");
    return true;
  }

  Error lost(const char* in_the_middle) const {
    if (!process_->gone() && silent())
      return Error(ErrorCode::peer_lost,
                   peer() + " gave no sign of life for " + std::to_string(segment_.head().lease) +
                       " ms (it was stopped, or its host is overloaded)" + in_the_middle,
                   {}, "tandem run --lease allows longer silence");
    return process_->lost(in_the_middle);
  }

  // There may be room for many messages to a dead peer, and each check costs a system call.
  void check_peer_sometimes() {
    const Clock::time_point now = Clock::now();
    if (now - checked_ < std::chrono::milliseconds(20)) return;
    checked_ = now;
    if (process_->check_peer() || silent()) throw lost("");
  }

  void expect_ready(shm::Waiter::Outcome outcome, const char* in_the_middle, const char* late) const {
    if (outcome == shm::Waiter::Outcome::gone) throw lost(in_the_middle);
    if (outcome == shm::Waiter::Outcome::deadline) throw Error(ErrorCode::timeout, peer() + " " + late);
  }

  End end_;
  std::unique_ptr<shm::PeerProcess> process_;
  shm::Segment segment_;
  shm::RingWriter out_;
  shm::RingReader in_;
  FailureLatch latch_;
  Clock::time_point checked_{};
  std::once_flag begun_;
  std::atomic<bool> beats_ = false;
  std::optional<shm::Heartbeat> heartbeat_;
};

std::unique_ptr<Channel> coordinator_end(Fd socket, const std::string& peer, const ShmOptions& options,
                                         std::optional<Deadline> await_attach) {
  auto process = std::make_unique<shm::PeerProcess>(std::move(socket), peer);
  const Fd memory = shm::create_memory(options.ring_bytes, options.lease);
  process->give_memory(memory);
  if (await_attach) process->await_attach(*await_attach);
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

constexpr const char* coordinator_name = "coordinator";
// A peer that has connected sends the memory at once; one that does not within this time no longer blocks
// others.
constexpr std::chrono::seconds handover{2};

// A peer that is not a coordinator does not end the wait.
std::unique_ptr<shm::PeerProcess> await_coordinator(const std::string& name, Fd& memory, Deadline deadline) {
  shm::NameListener listener(name);
  for (std::uint64_t failed = 0;;) {
    auto process = std::make_unique<shm::PeerProcess>(listener.accept(deadline), coordinator_name);
    try {
      memory = process->take_memory(std::min(deadline, Clock::now() + handover));
      return process;
    } catch (const Error& error) {
      // one line for each power of two
      if (std::has_single_bit(++failed))
        log::warn("who came to the name {} is no coordinator: {} ({} such so far); waiting on", name,
                  error.what(), failed);
    }
  }
}

}  // namespace

Endpoint create_shm(const std::string& peer, const ShmOptions& options) {
  auto [ours, theirs] = shm::socket_pair();
  Endpoint endpoint;
  endpoint.channel = coordinator_end(std::move(ours), peer, options, {});
  endpoint.server_arguments = {"--shm", std::string(inherited_prefix) + std::to_string(theirs.get())};
  endpoint.inherited.push_back(std::move(theirs));
  return endpoint;
}

std::unique_ptr<Channel> connect_shm(const std::string& name, const std::string& peer, Deadline deadline,
                                     const ShmOptions& options) {
  return coordinator_end(shm::connect_to(name, peer, deadline, options.idle), peer, options, deadline);
}

bool started_by_coordinator(const std::string& address) {
  return address.starts_with(inherited_prefix);
}

std::unique_ptr<Channel> attach_shm(const std::string& address, Deadline deadline, WaitPolicy wait) {
  Fd memory;
  std::unique_ptr<shm::PeerProcess> process;
  if (started_by_coordinator(address)) {
    process = std::make_unique<shm::PeerProcess>(inherited_socket(address), coordinator_name);
    memory = process->take_memory(deadline);
  } else {
    process = await_coordinator(address, memory, deadline);
  }
  return std::make_unique<ShmChannel>(std::move(process), memory, End::participant, wait);
}

}  // namespace tandem::protocol
