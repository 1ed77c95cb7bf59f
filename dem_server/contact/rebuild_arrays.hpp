// What a rebuild of the lists works with, and what it carries over from the old lists to the new ones.
#pragma once

#include <cstdint>

#include "dem_server/grid/size_levels.hpp"
#include "dem_server/laws/history.hpp"
#include "dem_server/state/particles.hpp"

namespace tandem::dem {

// A contact that was touched in the last micro step, which a rebuild carries over from the old lists to the
// new ones. That of two spheres is kept by the one in the lower old index. It is as large as a Place, a
// VelocityKind and a Spin, in whose memory it may lie.
template <class Real>
struct alignas(4 * sizeof(Real)) CarriedContact {
  std::uint32_t with = 0;  // the other sphere's old index, or wall_flag and a patch
  Vec3<Real> spring;       // see History [m]
};
inline constexpr std::uint32_t wall_flag = 1u << 31;  // beyond all indices and patches

inline constexpr std::uint32_t carried_beside =
    3;  // contacts for each sphere, in its Place, VelocityKind and Spin

// Entries of new lists, and what is carried over to them from the sphere that had the same index before.
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
  std::uint32_t* source = nullptr;        // index before sorting (n)
  std::uint32_t* cell_start = nullptr;    // first index of each cell, parked ones last
  std::uint32_t* coarse_start = nullptr;  // of each cell of a coarse level, in `coarse_index`
  std::uint32_t* coarse_index = nullptr;  // spheres by such cells, then those of the finest (n)
  ListCounts* count = nullptr;            // of each sphere, then of all below it (n + 1)
  // Of all carried_contact(), where lists have rolling springs (rolling_capacity)
  RollingSpring<Real>* carried_rolling = nullptr;
  std::uint32_t rolling_capacity = 0;
};

// The cells of all levels of sizes.
template <class Real>
struct GridView {
  CellGrid finest[2];  // see SizeLevels
  std::uint32_t levels = 1;
  typename LengthUnit<Real>::Count largest_of_finest{};  // radius, at most
  const CoarseLevel* coarse = nullptr;                   // (levels - 1)
};

}  // namespace tandem::dem
