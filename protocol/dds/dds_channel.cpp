#include "protocol/dds/dds_channel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "common/error.hpp"
#include "common/seconds.hpp"
#include "common/utf8.hpp"
#include "protocol/dds/barrier.hpp"
#include "protocol/dds/loan.hpp"
#include "protocol/dds/proof.hpp"
#include "protocol/dds/station.hpp"
#include "protocol/frame.hpp"
#include "protocol/latch.hpp"

namespace tandem::protocol {

namespace dds {

namespace {

constexpr std::uint64_t announce_every = max_chunks_ahead / 4;
constexpr std::uint64_t max_frame = sizeof(FrameHeader) + max_payload;

class DdsChannel : public Channel {
 public:
  DdsChannel(const DdsOptions& options, Side side, const Network& network, Deadline deadline)
      : station_(options, side, network),
        partner_(join(station_, options, side, network, deadline)),
        run_(options.run),
        where_(fmt::format("dds run '{}' on {}", options.run, network.interface)),
        lease_(options.lease),
        side_(side),
        proof_(make_proof(options)),
        incoming_(station_.reader()) {
    std::ranges::copy(station_.id(), out_.sender);
    std::ranges::copy(partner_.id(), out_.receiver);
  }

  void send(std::span<const std::span<const std::byte>> parts, Deadline deadline) override {
    latch_([&] { send_frame(parts, deadline); });
  }
  bool wait(Deadline deadline) override {
    return latch_([&] { return await_chunk(deadline) != nullptr; });
  }
  void receive(std::vector<std::byte>& frame, Deadline deadline) override {
    latch_([&] { receive_frame(frame, deadline); });
  }
  bool peer_gone() noexcept override { return station_.events().loss() != Loss::none; }
  const char* transport() const override { return "dds"; }
  const std::string& peer() const override { return partner_.name; }

 private:
  ChunkProof make_proof(const DdsOptions& options) const {
    const auto& presence = partner_.presence;
    const bool leads = side_ == Side::coordinator;
    return {options.secret,
            options.run,
            options.role,
            {leads ? std::span<const std::uint8_t>(station_.id()) : presence.end,
             leads ? std::span<const std::uint8_t>(presence.end) : station_.id(),
             leads ? std::span<const std::uint8_t>(station_.nonce()) : presence.own_nonce,
             leads ? std::span<const std::uint8_t>(presence.own_nonce) : station_.nonce()}};
  }

  void send_frame(std::span<const std::span<const std::byte>> parts, Deadline deadline) {
    out_.frame_size = 0;
    for (const auto& part : parts) out_.frame_size += part.size();
    gathered_.resize(std::min<std::uint64_t>(out_.frame_size, tandem_dds_max_chunk));

    std::uint64_t filled = 0, offset = 0;
    const auto flush = [&] {
      await_room(deadline);
      if (offset == 0) copy_header();
      out_.offset = offset;
      out_.number = sent_ + 1;
      out_.bytes = {static_cast<std::uint32_t>(filled), static_cast<std::uint32_t>(filled),
                    reinterpret_cast<std::uint8_t*>(gathered_.data()), false};
      side_ == Side::coordinator ? proof_.sign_command(out_) : proof_.sign_answer(out_);
      write(deadline);
      ++sent_;
      offset += filled;
      filled = 0;
    };
    for (std::span<const std::byte> part : parts) {
      while (!part.empty()) {
        const std::size_t count = std::min(part.size(), gathered_.size() - filled);
        std::memcpy(gathered_.data() + filled, part.data(), count);
        filled += count;
        part = part.subspan(count);
        if (filled == gathered_.size()) flush();
      }
    }
    if (filled > 0 || out_.frame_size == 0) flush();
  }

  // For DDS tools on the network; this channel does not read the copy.
  void copy_header() {
    FrameHeader header;
    if (gathered_.size() >= sizeof header) std::memcpy(&header, gathered_.data(), sizeof header);
    if (gathered_.size() < sizeof header || header.magic != frame_magic) header = {};
    out_.run_id = header.run_id;
    out_.generation = header.generation;
    out_.kind = static_cast<std::uint16_t>(header.kind);
    out_.window = header.window;
    out_.frame_sequence = header.sequence;
  }

  // Sleeps until the partner has taken enough of the sent chunks.
  void await_room(Deadline deadline) {
    for (;;) {
      const std::uint64_t seen = station_.events().count();
      check_partner();
      if (sent_ < partner_taken_ + max_chunks_ahead) return;
      for (const auto& end : station_.present())
        if (end_id(end.end) == partner_.id())
          partner_taken_ = std::max<std::uint64_t>(partner_taken_, end.taken);
      if (sent_ < partner_taken_ + max_chunks_ahead) return;
      if (Clock::now() >= deadline) throw timeout("took no message");
      station_.events().sleep(seen, deadline);
    }
  }

  void write(Deadline deadline) {
    for (int tries = 0;; ++tries) {
      const dds_return_t code = dds_write(station_.writer(), &out_);
      if (code != DDS_RETCODE_TIMEOUT) {
        checked(code, "write");
        return;
      }
      check_partner();
      // DDS waits for every reader, also for one outside the run.
      if (tries == 20 && station_.readers() > 1) {
        station_.strangers().report("an end that is not in the run",
                                    "it reads along, acknowledges nothing and so holds up this end; only "
                                    "certificates keep it out");
        station_.strangers().log_new(run_);
      }
      if (Clock::now() >= deadline) throw timeout("took no message");
    }
  }

  void receive_frame(std::vector<std::byte>& frame, Deadline deadline) {
    std::uint64_t filled = 0, frame_size = 0;
    do {
      const tandem_dds_Chunk* chunk = await_chunk(deadline);
      if (chunk == nullptr)
        throw timeout(filled == 0 ? "sent no message" : "stopped in the middle of a message");
      if (filled == 0) {
        if (chunk->frame_size > max_frame)
          throw broken("a frame of " + std::to_string(chunk->frame_size) + " bytes");
        frame_size = chunk->frame_size;
      }
      const std::uint64_t size = chunk->bytes._length;
      if (chunk->frame_size != frame_size || chunk->offset != filled || size > frame_size - filled ||
          (size == 0 && frame_size > 0)) {
        throw broken("chunks of a frame that do not fit together");
      }
      // Memory is allocated for bytes that have arrived, whatever size is announced.
      frame.resize(filled + size);
      if (size > 0) std::memcpy(frame.data() + filled, chunk->bytes._buffer, size);
      filled += size;
      incoming_.pop();
      if (++taken_ % announce_every == 0) station_.announce(&partner_.presence, taken_);
    } while (filled < frame_size);
  }

  // Returns the partner's next chunk, or null at the deadline.
  const tandem_dds_Chunk* await_chunk(Deadline deadline) {
    for (;;) {
      // Both are read before the reader is checked: chunks that arrived before a loss are delivered
      // before the error.
      const std::uint64_t seen = station_.events().count();
      const Loss loss = station_.events().loss();
      if (const tandem_dds_Chunk* chunk = next_chunk()) return chunk;
      if (loss != Loss::none) throw lost(loss);
      // With tags a gap shows in the numbers, and samples lost here may be those of strangers.
      if (!proof_.has_secret() && station_.events().samples_lost() > 0)
        throw broken("DDS lost a sample on the way");
      station_.strangers().log_new(run_);
      if (Clock::now() >= deadline) return nullptr;
      station_.events().sleep(seen, deadline);
    }
  }

  bool believed(const tandem_dds_Chunk& chunk) {
    if (side_ == Side::coordinator ? proof_.answer_holds(chunk) : proof_.command_holds(chunk)) return true;
    station_.strangers().report("who writes in the name of " + partner_.name, "its tag does not hold");
    return false;
  }

  const tandem_dds_Chunk* next_chunk() {
    for (;; incoming_.pop()) {
      const tandem_dds_Chunk* chunk = incoming_.front();
      if (chunk == nullptr) return nullptr;
      if (end_id(chunk->sender) != partner_.id() || end_id(chunk->receiver) != station_.id()) continue;
      if (!believed(*chunk)) continue;
      if (chunk->number != taken_ + 1) {
        throw broken(fmt::format("chunk {} where {} was next", chunk->number, taken_ + 1));
      }
      return chunk;
    }
  }

  void check_partner() const {
    if (const Loss loss = station_.events().loss(); loss != Loss::none) throw lost(loss);
  }

  Error lost(Loss loss) const {
    if (loss == Loss::closed) return Error(ErrorCode::peer_lost, partner_.name + " closed its end", where_);
    return Error(ErrorCode::peer_lost,
                 fmt::format("{} fell silent for {} ms: it died, was stopped, or the network is down",
                             partner_.name, lease_.count()),
                 where_);
  }
  Error timeout(const char* what) const {
    return Error(ErrorCode::timeout, partner_.name + " " + what, where_);
  }
  Error broken(const std::string& what) const {
    return Error(ErrorCode::protocol, partner_.name + ": " + what, where_);
  }

  Station station_;
  Partner partner_;
  std::string run_, where_;
  std::chrono::milliseconds lease_;
  Side side_;
  ChunkProof proof_;
  FailureLatch latch_;
  tandem_dds_Chunk out_{};
  std::vector<std::byte> gathered_;  // one chunk
  Loan incoming_;
  std::uint64_t sent_ = 0, partner_taken_ = 0, taken_ = 0;  // chunks
};

void check(const DdsOptions& options) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_' || c == '.'; };
  if (options.run.empty() || options.run.size() > 128 || !std::ranges::all_of(options.run, plain)) {
    throw Error(ErrorCode::usage, "'" + shortened(options.run) + "' is no name for a run", "dds",
                "use 1 to 128 letters, digits, '-', '_' and '.'");
  }
  if (options.lease < least_lease || options.lease > most_lease) {
    throw Error(ErrorCode::usage, fmt::format("a lease of {} ms", options.lease.count()), "dds",
                fmt::format("use {} to {} ms", least_lease.count(), most_lease.count()));
  }
  if (options.secret.empty() && options.certificates.empty() && !options.insecure) {
    throw Error(ErrorCode::usage, fmt::format("run '{}' over the network has no secret", options.run), "dds",
                "give --secret-file FILE or set TANDEM_SECRET, the same for all programs of the run; or say "
                "--insecure where whoever reaches the network may read and change the run");
  }
}

std::unique_ptr<Channel> open(const DdsOptions& options, Side side, Deadline deadline) {
  check(options);
  return std::make_unique<DdsChannel>(options, side, find_network(options), deadline);
}

}  // namespace

}  // namespace dds

std::unique_ptr<Channel> open_dds_coordinator(const DdsOptions& options, Deadline deadline) {
  return dds::open(options, dds::Side::coordinator, deadline);
}

std::unique_ptr<Channel> open_dds_participant(const DdsOptions& options, Deadline deadline) {
  return dds::open(options, dds::Side::participant, deadline);
}

}  // namespace tandem::protocol

#if defined(__SANITIZE_THREAD__)
// The thread sanitizer does not see the atomics inside Cyclone DDS and OpenSSL, which are built without it,
// and would report the accesses that they order as races. Our own code, listeners included, is still checked.
// The first name must match one library that stays loaded: Debian keeps the security plug-ins, which are
// loaded and unloaded, in a folder libddsc0debian.
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:libddsc.so\nrace:libdds_security_\nrace:libcrypto.so\n";
}
#endif
