// Tags by which the ends of a run authenticate each other, made with keys derived from the run's secret.
// Without a secret tags are zeros and every message is accepted.
#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "protocol/dds/keys.hpp"
#include "protocol/messages.hpp"
#include "wire.h"

namespace tandem::protocol::dds {

// Tags of presences, which precede the pairing: by the secret, the run and the role. Any thread.
class PresenceProof {
 public:
  PresenceProof(const std::string& secret, const std::string& run, Role role);
  bool has_secret() const { return authenticator_.has_value(); }
  void sign(tandem_dds_Presence& presence);
  bool holds(const tandem_dds_Presence& presence);

 private:
  Tag tag_of(const tandem_dds_Presence& presence);
  std::mutex mutex_;
  std::optional<Authenticator> authenticator_;
};

// Tags of the chunks of one pair, by keys derived from the nonces of both ends, so that a recording of
// another pair has other tags. One thread.
class ChunkProof {
 public:
  struct Pair {
    std::span<const std::uint8_t> coordinator, participant;  // ids
    std::span<const std::uint8_t> coordinator_nonce, participant_nonce;
  };
  ChunkProof(const std::string& secret, const std::string& run, Role role, const Pair& pair);
  bool has_secret() const { return commands_.has_value(); }
  void sign_command(tandem_dds_Chunk& chunk) { sign(commands_, chunk); }
  void sign_answer(tandem_dds_Chunk& chunk) { sign(answers_, chunk); }
  bool command_holds(const tandem_dds_Chunk& chunk) { return holds(commands_, chunk); }
  bool answer_holds(const tandem_dds_Chunk& chunk) { return holds(answers_, chunk); }

 private:
  using Direction = std::optional<Authenticator>;
  static void sign(Direction& direction, tandem_dds_Chunk& chunk);
  static bool holds(Direction& direction, const tandem_dds_Chunk& chunk);
  Direction commands_, answers_;
};

}  // namespace tandem::protocol::dds
