// Beds that have settled, on the disk: the second run of a scene starts at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/scene/settle.hpp"
#include "coordinator/scene/start_cache.hpp"

namespace tandem::launch {

// What a settled bed follows from.
struct SettleKey {
  std::string text;          // all of it; scenes, meshes and files by digests
  std::string name() const;  // of its file
};

// `file`: its packings are not placed yet, all other spheres are known. The key also has the digest of this
// program, so that no bed of another version is taken.
SettleKey key_of(const SceneFile& file, const scene::Settle& settle);

struct CachedBed {
  Settled settled;
  std::vector<PlacedGroup> placed;
};

// See StartCache.
class SettleCache {
 public:
  SettleCache() = default;
  SettleCache(std::filesystem::path folder, std::uint64_t limit) : files_(std::move(folder), limit) {}

  std::optional<CachedBed> find(const SettleKey& key, std::vector<std::string>& log) const;
  void keep(const SettleKey& key, const CachedBed& bed, std::vector<std::string>& log) const;

 private:
  StartCache files_;
};

}  // namespace tandem::launch
