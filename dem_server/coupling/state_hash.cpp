#include "dem_server/coupling/state_hash.hpp"

#include <fmt/format.h>

#include <bit>

namespace tandem::dem {

std::string state_hash(const Spheres& s) {
  // FNV-1a over 64-bit words.
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto mix = [&hash](std::uint64_t word) { hash = (hash ^ word) * 0x100000001b3u; };
  for (std::size_t i = 0; i < s.size(); ++i) {
    mix(s.id[i]);
    for (const Vec3d& v : {s.position[i], s.velocity[i], s.spin[i]})
      for (int a = 0; a < 3; ++a) mix(std::bit_cast<std::uint64_t>(v[a]));
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace tandem::dem
