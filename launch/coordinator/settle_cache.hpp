// Beds that have settled, on the disk: the second run of a scene starts at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "launch/coordinator/settle.hpp"

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

class SettleCache {
 public:
  // In the folder that TANDEM_CACHE names, or in `tandem` of XDG_CACHE_HOME or of ~/.cache; none where
  // TANDEM_CACHE is `off`. TANDEM_CACHE_MB limits its size (2000). Throws Error{usage} where that is no
  // number.
  SettleCache();
  // With `folder` and limit [bytes].
  SettleCache(std::filesystem::path folder, std::uint64_t limit)
      : folder_(std::move(folder)), limit_(limit) {}

  // Nothing where it is not there, or is damaged: that is removed, and a sentence says it. Nothing with a
  // sentence where the folder or the file belongs to another user, or others can write it.
  std::optional<CachedBed> find(const SettleKey& key, std::vector<std::string>& log) const;
  // Beds that were not used for the longest time are removed first, until all have room. A sentence says
  // where the bed could not be kept; the run does not need it.
  void keep(const SettleKey& key, const CachedBed& bed, std::vector<std::string>& log) const;

 private:
  std::filesystem::path path_of(const SettleKey& key) const { return folder_ / key.name(); }
  void make_room(std::uint64_t bytes, std::vector<std::string>& log) const;

  std::filesystem::path folder_;  // empty: there is none
  std::uint64_t limit_ = 0;       // [bytes]
};

}  // namespace tandem::launch
