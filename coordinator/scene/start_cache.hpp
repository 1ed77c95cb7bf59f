// What takes long to compute before a run, on the disk: the second run of a scene starts at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/math/vec3.hpp"
#include "common/state_file.hpp"

namespace tandem::launch {

// Two digests with different starts, 128 bits.
std::string digest_text(std::span<const std::byte> bytes);

// Vectors as the numbers of an array of a state.
std::span<const double> numbers(const std::vector<Vec3d>& rows);
std::vector<Vec3d> rows_in(const StateReader& file, const std::string& name);

class StartCache {
 public:
  struct Entry {
    std::string kind;    // what it is, for messages and in its file: "settled bed"
    std::string prefix;  // of the name of its file: "settled_" or "filled_"
    std::string key;     // all that it follows from
    std::string name() const;
  };

  // In the folder that TANDEM_CACHE names, or in `tandem` of XDG_CACHE_HOME or of ~/.cache; none where
  // TANDEM_CACHE is `off`. TANDEM_CACHE_MB limits its size (2000). Throws Error{usage} where that is no
  // number.
  StartCache();
  // With `folder` and limit [bytes].
  StartCache(std::filesystem::path folder, std::uint64_t limit) : folder_(std::move(folder)), limit_(limit) {}

  // Calls read(file) where the entry is there, and says whether it was read. One that is damaged, so that
  // read() throws an Error, is removed, and a sentence says it. Nothing with a sentence where the folder or
  // the file belongs to another user, or others can write it.
  bool find(const Entry& entry, const std::function<void(const StateReader&)>& read,
            std::vector<std::string>& log) const;
  // bytes: about its size. What was not used for the longest time is removed first, until all have room. A
  // sentence says where the entry could not be kept; the run does not need it.
  void keep(const Entry& entry, std::uint64_t bytes, const std::function<void(StateWriter&)>& write,
            std::vector<std::string>& log) const;

 private:
  std::filesystem::path path_of(const Entry& entry) const { return folder_ / entry.name(); }
  void make_room(std::uint64_t bytes, std::vector<std::string>& log) const;

  std::filesystem::path folder_;  // empty: there is none
  std::uint64_t limit_ = 0;       // [bytes]
};

}  // namespace tandem::launch
