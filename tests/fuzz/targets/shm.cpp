// A hostile peer of the same user at the other end of a shared memory: any bytes in the head, in the rings
// and on the socket, and memory of any size. The peer stays alive, and half of the peers keep writing into
// the memory while it is in use.
#include "protocol/shm/shm_channel.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <thread>

#include "protocol/frame.hpp"
#include "protocol/layout.hpp"
#include "protocol/shm/name_socket.hpp"
#include "protocol/shm/segment.hpp"
#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/frames_of_messages.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {
namespace shm_part {

using namespace protocol;
using namespace std::chrono_literals;

// An input has the end under test, the byte that the peer sends on the socket, how it hands over the memory,
// a quarter of the number of its later writes, the size of the memory (in pieces of 64 bytes), and the
// beginning of the memory.
constexpr unsigned coordinator = 0, participant = 1, ends = 2;
struct Order {
  std::uint8_t said = 'a', sealed = 1, handed = 1, writes = 0;
  std::uint32_t pieces = 0;
};
constexpr std::size_t ring = 4096, whole = sizeof(shm::SegmentHead) + 2 * ring;
constexpr std::size_t piece = 64;

class Mapping {
 public:
  Mapping(const Fd& memory, std::size_t size)
      : at_(mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, memory.get(), 0)), size_(size) {
    if (at_ == MAP_FAILED) throw std::runtime_error("memory cannot be mapped");
  }
  ~Mapping() { munmap(at_, size_); }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  std::span<std::byte> bytes() const { return {static_cast<std::byte*>(at_), size_}; }

 private:
  void* at_;
  std::size_t size_;
};

void overwrite(std::span<std::byte> memory, std::span<const std::byte> bytes) {
  std::ranges::copy(bytes.first(std::min(memory.size(), bytes.size())), memory.begin());
}

Fd taken_from(const Fd& socket) {
  char byte = 0;
  iovec data{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> buffer{};
  msghdr message{};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = buffer.data();
  message.msg_controllen = buffer.size();
  if (recvmsg(socket.get(), &message, MSG_CMSG_CLOEXEC) != 1)
    throw std::runtime_error("no memory was handed over");
  int fd = -1;
  std::memcpy(&fd, CMSG_DATA(CMSG_FIRSTHDR(&message)), sizeof fd);
  return Fd(fd);
}

void hand_over(const Fd& socket, std::uint8_t byte, const Fd* memory) {
  iovec data{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> buffer{};
  msghdr message{};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  if (memory) {
    message.msg_control = buffer.data();
    message.msg_controllen = buffer.size();
    cmsghdr* rights = CMSG_FIRSTHDR(&message);
    rights->cmsg_level = SOL_SOCKET;
    rights->cmsg_type = SCM_RIGHTS;
    rights->cmsg_len = CMSG_LEN(sizeof(int));
    const int fd = memory->get();
    std::memcpy(CMSG_DATA(rights), &fd, sizeof fd);
  }
  if (sendmsg(socket.get(), &message, MSG_NOSIGNAL) != 1) throw std::runtime_error("nothing can be sent");
}

// Writes words into the counters and the rings while they are in use. The words depend only on the number of
// writes.
class Stirrer {
 public:
  Stirrer(std::span<std::byte> memory, unsigned writes) {
    if (writes == 0 || memory.size() < whole) return;
    thread_ = std::jthread([this, memory, writes](const std::stop_token& stop) {
      Random random(writes, 0);
      begun_ = true;
      begun_.notify_one();
      for (unsigned left = 4 * writes; left > 0 && !stop.stop_requested(); --left) {
        const std::size_t at = random.below(random.one_in(4) ? whole - 8 : sizeof(shm::SegmentHead)) / 8 * 8;
        std::uint64_t word = random.bits() >> (8 * random.below(8));
        if (random.one_in(2)) word %= ring;
        std::memcpy(memory.data() + at, &word, random.one_in(2) ? 8 : 4);
        std::this_thread::yield();
      }
    });
    begun_.wait(false);
  }

 private:
  std::atomic<bool> begun_ = false;
  std::jthread thread_;
};

// Reads and writes until an error occurs. It does not wait: valid frames are already in the ring.
void use(Channel& channel, const Mapping& mapping, unsigned writes) {
  const std::size_t longest = (1 + 4 * writes) * ring;
  const Stirrer stirrer(mapping.bytes(), writes);
  protocol::Bytes frame;
  const Bytes answer(ring / 2);
  const std::span<const std::byte> parts[] = {answer};
  for (int i = 0; i < 4; ++i) {
    channel.receive(frame, Clock::now() + 1ms);
    expect(frame.size() <= longest, "a frame is longer than all that was written");
    open_frame(frame, channel.peer());
  }
  channel.send(parts, Clock::now() + 1ms);
}

class ShmTarget : public Target {
 public:
  void run(std::span<const std::byte> input) override {
    const unsigned end = chosen(input, ends);
    Order order;
    const auto first = input.first(std::min(sizeof order, input.size()));
    std::ranges::copy(first, std::as_writable_bytes(std::span(&order, 1)).begin());
    const auto memory = input.subspan(first.size());
    if (end == coordinator)
      before_a_coordinator(order, memory);
    else
      before_a_participant(order, memory);
  }

 private:
  void before_a_coordinator(const Order& order, std::span<const std::byte> bytes) {
    Endpoint endpoint = create_shm("peer", {.ring_bytes = ring, .wait = WaitPolicy::adaptive});
    const Fd& socket = endpoint.inherited[0];
    const Fd memory = taken_from(socket);
    if (order.said != 0) hand_over(socket, order.said, nullptr);
    const Mapping mapping(memory, whole);
    overwrite(mapping.bytes(), bytes);
    use(*endpoint.channel, mapping, order.writes);
  }
  void before_a_participant(const Order& order, std::span<const std::byte> bytes) {
    auto [ours, theirs] = shm::socket_pair();
    const std::size_t size = std::min<std::size_t>(order.pieces, 4096) * piece;
    const Fd memory(memfd_create("fuzz", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    if (ftruncate(memory.get(), static_cast<off_t>(size)) != 0) throw std::runtime_error("no memory");
    const Mapping mapping(memory, std::max(size, piece));  // nothing is written beyond `size`
    overwrite(mapping.bytes().first(size), bytes);
    if (order.sealed % 2 == 1) fcntl(memory.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL);
    hand_over(ours, order.said, order.handed % 2 == 1 ? &memory : nullptr);
    // attach_shm() closes the descriptor that it is given.
    const int given = fcntl(theirs.get(), F_DUPFD_CLOEXEC, 3);
    theirs = Fd();
    const auto channel = attach_shm("fd:" + std::to_string(given), Clock::now() + 5s);
    use(*channel, mapping, order.writes);
  }
};

// The memory after an honest peer has sent four frames.
Bytes honest_memory(unsigned end) {
  const Fd memory = shm::create_memory(ring, default_shm_lease);
  const Mapping mapping(memory, whole);
  auto& head = *reinterpret_cast<shm::SegmentHead*>(mapping.bytes().data());
  shm::RingHead& out = end == coordinator ? head.to_coordinator : head.to_participant;
  (end == coordinator ? head.participant_beats : head.coordinator_beats) = 1;
  std::span<std::byte> bytes = mapping.bytes().subspan(sizeof head + (end == coordinator ? ring : 0), ring);
  const std::vector<protocol::Bytes> frames = frames_of_messages();
  std::uint64_t at = 0;
  for (const std::size_t i : {0u, 1u, 5u, 11u}) {
    const std::uint64_t size = frames[i].size();
    std::memcpy(bytes.data() + at, &size, sizeof size);
    std::memcpy(bytes.data() + at + sizeof size, frames[i].data(), size);
    at += sizeof size + size;
  }
  out.written = at;
  Order order;
  order.pieces = whole / piece;
  if (whole % piece != 0) throw std::logic_error("the memory is not a whole number of pieces");
  const auto first = std::as_bytes(std::span(&order, 1));
  Bytes all(first.begin(), first.end());
  all.insert(all.end(), mapping.bytes().begin(), mapping.bytes().end());
  return choice(end, all);
}

// Most bytes of the memory are never read; this damages some of those that are.
Fate finish_shm(Random& random, Bytes& input) {
  constexpr std::size_t read_first = 1 + sizeof(Order) + sizeof(shm::SegmentHead);
  if (input.size() < read_first) return Fate::open;
  for (std::size_t changes = random.below(3); changes > 0; --changes) {
    const std::size_t at = 1 + random.below(read_first - 8);
    const std::uint64_t word = random.bits() >> (8 * random.below(8));
    std::memcpy(input.data() + at, &word, std::size_t{1} << random.below(4));
  }
  if (random.one_in(2)) input[1 + offsetof(Order, writes)] = static_cast<std::byte>(random.bits());
  return Fate::open;
}

}  // namespace shm_part

TargetKind shm_target() {
  using namespace shm_part;
  return {.name = "shm",
          .corpus = [](const std::filesystem::path&) -> std::vector<Bytes> {
            return {honest_memory(coordinator), honest_memory(participant)};
          },
          .make = make_target<ShmTarget>,
          .finish = finish_shm};
}

}  // namespace tandem::fuzz
