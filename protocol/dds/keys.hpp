// Keys and tags of a run over DDS, by OpenSSL: HMAC-SHA-256 (RFC 2104) and HKDF (RFC 5869).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace tandem::protocol::dds {

using Key = std::array<std::uint8_t, 32>;
using Tag = std::array<std::uint8_t, 32>;
using Nonce = std::array<std::uint8_t, 32>;

// A random number that nobody can guess. Throws Error{resource} where the system has none.
Nonce fresh_nonce();

// Derives one key for each use: `info` names the use, `salt` has the contributions of both ends.
Key derive_key(std::string_view secret, std::span<const std::uint8_t> salt, std::string_view info);

// Whether two tags are equal, in constant time.
bool equal(const Tag& a, const Tag& b);

// Authenticates messages one after another with one key. One thread at a time; does not allocate.
class Authenticator {
 public:
  explicit Authenticator(const Key& key);
  // Begins a message.
  void begin();
  void add(const void* data, std::size_t size);
  template <class T>
  void add(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    add(&value, sizeof value);
  }
  Tag finish();

 private:
  struct Free {
    void operator()(void* context) const;
  };
  std::unique_ptr<void, Free> context_;
};

}  // namespace tandem::protocol::dds
