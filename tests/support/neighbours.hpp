// The neighbours that the lists of an engine hold.
#pragma once

#include <cstdint>
#include <set>

#include "dem_server/contact/view.hpp"
#include "tests/support/particle_run.hpp"

namespace tandem::test {

// Neighbours of the sphere with this id, whichever of a pair lists the other.
inline std::set<std::uint32_t> neighbours_of(const ParticleRun& run, std::uint32_t sphere) {
  const Arrays arrays = written(run);
  const auto start = array_of<std::uint32_t>(arrays, "pairs.start"), id = ids_of(arrays);
  const auto entry = array_of<dem::Neighbour>(arrays, "pairs.entry");
  std::set<std::uint32_t> found;
  for (std::uint32_t i = 0; i < id.size(); ++i)
    for (std::uint32_t k = start[i]; k < start[i + 1]; ++k) {
      const std::uint32_t j = entry[k].index();
      if (id[i] == sphere) found.insert(id[j]);
      if (id[j] == sphere) found.insert(id[i]);
    }
  return found;
}

}  // namespace tandem::test
