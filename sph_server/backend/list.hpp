// A list of entries for each particle in the memory of a back end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "common/error.hpp"
#include "sph_server/neighbours/find.hpp"

namespace tandem::sph {

// Entries are numbered with 32 bits. Error{resource} where there are more.
inline std::uint32_t checked_total(std::size_t entries) {
  if (entries <= std::numeric_limits<std::uint32_t>::max()) return static_cast<std::uint32_t>(entries);
  throw Error(ErrorCode::resource, "the lists of neighbours have " + std::to_string(entries) + " entries",
              "liquid", "give a larger sph.spacing");
}

template <class Exec, class Entry>
struct List {
  typename Exec::template Buffer<std::uint32_t> start;  // see ListView (particles + 1)
  typename Exec::template Buffer<std::uint32_t> end;  // empty where each begins at the end of the one before
  typename Exec::template Buffer<Entry> entry;        // `total` of them, and room
  std::uint32_t total = 0;

  ListView<Entry> view() const {
    return {start.data(), end.size() > 0 ? end.data() : start.data() + 1, entry.data()};
  }
};

}  // namespace tandem::sph
