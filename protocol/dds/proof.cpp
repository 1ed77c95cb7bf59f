#include "protocol/dds/proof.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include "protocol/version.hpp"

namespace tandem::protocol::dds {
namespace {

// Purpose of a key, so that no key serves two purposes. A run's name contains no '/'.
std::string use_of_key(const char* use, const std::string& run, Role role) {
  return std::string("tandem 1/") + use + "/" + run + "/" + name(role);
}

Tag to_tag(const std::uint8_t (&bytes)[32]) {
  return std::to_array(bytes);
}

Tag tag_of_chunk(Authenticator& authenticator, const tandem_dds_Chunk& chunk) {
  Authenticator& a = authenticator;
  a.begin();
  a.add(chunk.sender, sizeof chunk.sender);
  a.add(chunk.receiver, sizeof chunk.receiver);
  a.add(chunk.number);
  a.add(chunk.frame_size);
  a.add(chunk.offset);
  a.add(chunk.run_id);
  a.add(chunk.generation);
  a.add(chunk.kind);
  a.add(chunk.window);
  a.add(chunk.frame_sequence);
  a.add(chunk.bytes._length);
  a.add(chunk.bytes._buffer, chunk.bytes._length);
  return a.finish();
}

}  // namespace

PresenceProof::PresenceProof(const std::string& secret, const std::string& run, Role role) {
  if (!secret.empty()) authenticator_.emplace(derive_key(secret, {}, use_of_key("presence", run, role)));
}

void PresenceProof::sign(tandem_dds_Presence& presence) {
  presence.asks = has_secret() ? tandem_dds_secret_proof : tandem_dds_no_proof;
  const Tag tag = has_secret() ? tag_of(presence) : Tag{};
  std::ranges::copy(tag, presence.tag);
}

bool PresenceProof::holds(const tandem_dds_Presence& presence) {
  if (!has_secret()) return true;
  return presence.asks == tandem_dds_secret_proof && equal(tag_of(presence), to_tag(presence.tag));
}

Tag PresenceProof::tag_of(const tandem_dds_Presence& presence) {
  const std::lock_guard lock(mutex_);
  Authenticator& a = *authenticator_;
  a.begin();
  a.add(presence.end, sizeof presence.end);
  a.add(&presence.side, sizeof presence.side);
  a.add(&presence.asks, sizeof presence.asks);
  a.add(presence.own_nonce, sizeof presence.own_nonce);
  a.add(presence.partner, sizeof presence.partner);
  a.add(presence.partner_nonce, sizeof presence.partner_nonce);
  a.add(presence.taken);
  a.add(presence.layout_hash);
  a.add(presence.pid);
  a.add(presence.host, strnlen(presence.host, sizeof presence.host));
  return a.finish();
}

ChunkProof::ChunkProof(const std::string& secret, const std::string& run, Role role, const Pair& pair) {
  if (secret.empty()) return;
  std::vector<std::uint8_t> salt;
  for (const auto part : {pair.coordinator_nonce, pair.participant_nonce, pair.coordinator, pair.participant})
    salt.insert(salt.end(), part.begin(), part.end());
  commands_.emplace(derive_key(secret, salt, use_of_key("commands", run, role)));
  answers_.emplace(derive_key(secret, salt, use_of_key("answers", run, role)));
}

void ChunkProof::sign(Direction& direction, tandem_dds_Chunk& chunk) {
  const Tag tag = direction ? tag_of_chunk(*direction, chunk) : Tag{};
  std::ranges::copy(tag, chunk.tag);
}

bool ChunkProof::holds(Direction& direction, const tandem_dds_Chunk& chunk) {
  return !direction || equal(tag_of_chunk(*direction, chunk), to_tag(chunk.tag));
}

}  // namespace tandem::protocol::dds
