// Work arrays of a rebuild of the lists, among them the contacts that it carries over from the old lists to
// the new ones.
#pragma once

#include <cstdint>

#include "dem_server/laws/history.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/grid/index_order.hpp"
#include "particles/grid/size_levels.hpp"
#include "particles/state/particles.hpp"

namespace tandem::dem {

// A contact of the last micro step that a rebuild carries over from the old lists to the new ones. A contact
// of two spheres is saved by the one with the lower old index. Its size equals that of a PositionRadius, a
// VelocityKind and a Spin, because it may be stored in their memory.
template <class Real>
struct alignas(4 * sizeof(Real)) CarriedContact {
  std::uint32_t with = 0;  // old index of the other sphere, or wall_flag and a patch
  Vec3<Real> spring;       // see History [m]
};
inline constexpr std::uint32_t wall_flag = 1u << 31;  // above all indices and patches

// Contacts per sphere that fit into its PositionRadius, VelocityKind and Spin
inline constexpr std::uint32_t carried_in_state = 3;

// Entries of new lists, and contacts carried over from the sphere that had the same index before.
struct ListCounts {
  std::uint32_t pairs = 0, mirrors = 0, walls = 0;
  std::uint32_t near = 0;  // bodies
  std::uint32_t carried = 0;

  TANDEM_HD friend ListCounts operator+(const ListCounts& a, const ListCounts& b) {
    return {a.pairs + b.pairs, a.mirrors + b.mirrors, a.walls + b.walls, a.near + b.near,
            a.carried + b.carried};
  }
};

template <class Real>
struct RebuildArrays {
  // Of the spheres before they are sorted: those that come from other ranks stand behind the others.
  particles::IndexOrder order;
  std::uint32_t* source = nullptr;        // index before sorting (n)
  std::uint32_t* cell_start = nullptr;    // first index of each cell, those of parked spheres last
  std::uint32_t* coarse_start = nullptr;  // per cell of a coarse level: begin in `coarse_index`
  std::uint32_t* coarse_index = nullptr;  // spheres sorted by these cells, then those of the finest level (n)
  ListCounts* count = nullptr;            // per sphere, then summed over all lower indices (n + 1)
  // Of each carried_contact(), where lists have rolling springs (rolling_capacity)
  RollingSpring<Real>* carried_rolling = nullptr;
  std::uint32_t rolling_capacity = 0;
};

// The cells of all levels of sizes.
template <class Real>
struct GridView {
  CellGrid finest[2];  // see SizeLevels
  std::uint32_t levels = 1;
  typename LengthUnit<Real>::Count largest_of_finest{};  // largest radius of that level
  const CoarseLevel* coarse = nullptr;                   // (levels - 1)
};

}  // namespace tandem::dem
