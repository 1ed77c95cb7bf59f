// Keys and tags: known values of the standards, and that no changed bit passes.
#include "protocol/dds/proof.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace tandem::protocol::dds {
namespace {

template <class Bytes>
std::string hex(const Bytes& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes)
    (text += "0123456789abcdef"[byte >> 4]) += "0123456789abcdef"[byte & 15];
  return text;
}

TEST(Keys, TagsAreThoseOfRfc4231) {
  Key key{};  // test case 2: HMAC pads a key with zeros, so "Jefe" may have them
  std::memcpy(key.data(), "Jefe", 4);
  Authenticator authenticator(key);
  for (int i = 0; i < 2; ++i) {
    authenticator.begin();
    authenticator.add("what do ya want ", 16);
    authenticator.add("for nothing?", 12);
    EXPECT_EQ(hex(authenticator.finish()),
              "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
  }
}

TEST(Keys, KeysAreThoseOfRfc5869) {
  const std::string secret(22, '\x0b');
  std::vector<std::uint8_t> salt;
  for (std::uint8_t i = 0; i < 13; ++i) salt.push_back(i);
  std::string info;
  for (int i = 0xf0; i < 0xfa; ++i) info += static_cast<char>(i);
  EXPECT_EQ(hex(derive_key(secret, salt, info)),
            "3cb25f25faacd57a90434f64d0362f2a2d2d0a90cf1a5a4c5db02d56ecc4c5bf");
  EXPECT_EQ(hex(derive_key(secret, {}, "")),
            "8da4e775a563c18f715f802a063c5a31b8a11f5c5ee1879ec3454e5f3c738d2d");
}

TEST(Keys, NoncesDiffer) {
  EXPECT_NE(fresh_nonce(), fresh_nonce());
}

const std::string secret = "a secret of thirty-two characters";

struct Talk {
  std::array<std::uint8_t, 16> a{1}, b{2};
  Nonce na{3}, nb{4};
  ChunkProof proof(const std::string& of = secret, const std::string& run = "run",
                   Role role = Role::dem) const {
    return {of, run, role, {a, b, na, nb}};
  }
};

TEST(ChunkProof, HoldsForThePairTheRunTheRoleAndTheDirectionOnly) {
  std::vector<std::uint8_t> bytes(100, 5);
  tandem_dds_Chunk chunk{};
  chunk.number = 7;
  chunk.bytes = {100, 100, bytes.data(), false};
  const Talk talk;
  talk.proof().sign_command(chunk);
  EXPECT_TRUE(talk.proof().command_holds(chunk));
  EXPECT_FALSE(talk.proof().answer_holds(chunk)) << "sent back to its sender";
  EXPECT_FALSE(talk.proof(secret, "other").command_holds(chunk));
  EXPECT_FALSE(talk.proof(secret, "run", Role::mbd).command_holds(chunk));
  EXPECT_FALSE(talk.proof(secret + "x").command_holds(chunk));
  Talk later;
  later.nb = {5};
  EXPECT_FALSE(later.proof().command_holds(chunk)) << "a recording of an earlier start";
  EXPECT_TRUE(talk.proof("").command_holds(chunk)) << "without a secret everything is believed";
}

TEST(ChunkProof, NoChangedBitPasses) {
  std::vector<std::uint8_t> bytes(64, 5);
  tandem_dds_Chunk chunk{};
  chunk.bytes = {64, 64, bytes.data(), false};
  ChunkProof proof = Talk().proof();
  proof.sign_answer(chunk);
  const auto expect_noticed = [&](std::uint8_t* data, std::size_t size, const char* what) {
    for (std::size_t bit = 0; bit < 8 * size; ++bit) {
      data[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
      EXPECT_FALSE(proof.answer_holds(chunk)) << what << ", bit " << bit;
      data[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    }
  };
  const auto field = [&](auto& value, const char* what) {
    expect_noticed(reinterpret_cast<std::uint8_t*>(&value), sizeof value, what);
  };
  field(chunk.sender, "sender");
  field(chunk.receiver, "receiver");
  field(chunk.number, "number");
  field(chunk.frame_size, "frame_size");
  field(chunk.offset, "offset");
  field(chunk.run_id, "run_id");
  field(chunk.generation, "generation");
  field(chunk.kind, "kind");
  field(chunk.window, "window");
  field(chunk.frame_sequence, "frame_sequence");
  field(chunk.tag, "tag");
  expect_noticed(bytes.data(), bytes.size(), "bytes");
  chunk.bytes._length = 63;
  EXPECT_FALSE(proof.answer_holds(chunk));
  chunk.bytes._length = 64;
  EXPECT_TRUE(proof.answer_holds(chunk));
}

TEST(PresenceProof, NoChangedBitPasses) {
  PresenceProof proof(secret, "run", Role::dem);
  tandem_dds_Presence presence{};
  std::strcpy(presence.host, "nodeb");
  proof.sign(presence);
  EXPECT_TRUE(proof.holds(presence));
  const auto field = [&](auto& value, const char* what) {
    auto* data = reinterpret_cast<std::uint8_t*>(&value);
    for (std::size_t bit = 0; bit < 8 * sizeof value; ++bit) {
      data[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
      EXPECT_FALSE(proof.holds(presence)) << what << ", bit " << bit;
      data[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    }
  };
  field(presence.end, "end");
  field(presence.side, "side");
  field(presence.own_nonce, "own_nonce");
  field(presence.partner, "partner");
  field(presence.partner_nonce, "partner_nonce");
  field(presence.taken, "taken");
  field(presence.layout_hash, "layout_hash");
  field(presence.pid, "pid");
  field(presence.tag, "tag");
  presence.host[0] = 'm';
  EXPECT_FALSE(proof.holds(presence));
  EXPECT_FALSE(PresenceProof(secret, "other", Role::dem).holds(presence));
}

}  // namespace
}  // namespace tandem::protocol::dds
