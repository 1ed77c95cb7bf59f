// Digest of the state of particles, for the hash of a run: FNV-1a over 64-bit words.
#pragma once

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <string>

#include "common/math/vec3.hpp"

namespace tandem::particles {

class StateDigest {
 public:
  void mix(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001b3u; }
  void mix(double value) { mix(std::bit_cast<std::uint64_t>(value)); }
  void mix(const Vec3d& v) {
    for (int a = 0; a < 3; ++a) mix(v[a]);
  }
  std::string text() const { return fmt::format("{:016x}", hash_); }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace tandem::particles
