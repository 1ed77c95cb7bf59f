// Arrays that only ranks have (engine/engine_ranks.hpp).
#pragma once

#include <cstdint>

#include "dem_server/engine/contact_tangent.hpp"
#include "dem_server/engine/travelling.hpp"
#include "dem_server/laws/particle_names.hpp"

namespace tandem::dem {

// Work of a sphere in a micro step, and the block of cells in which it is.
struct PlacedWork {
  static constexpr std::uint32_t nowhere = ~0u;
  std::uint32_t block = nowhere, work = 0;
};

template <class Exec, class Real>
struct RankBuffers {
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;
  struct Travellers {
    Buffer<TravellingSphere<Real>> spheres;
    Buffer<TravellingContact<Real>> contacts;
    Buffer<TravellingWall<Real>> walls;

    // Keeps the contents.
    void grow(Exec& exec, const Travelling& wanted) {
      const auto with_spare = [&exec](auto& buffer, std::size_t count) {
        if (buffer.size() < count) exec.grow(buffer, count + count / 8 + 64);
      };
      with_spare(spheres, wanted.spheres), with_spare(contacts, wanted.contacts);
      with_spare(walls, wanted.walls);
    }
  };

  Buffer<std::uint32_t> ordinal;   // of each index: that where one process had all spheres
  Buffer<std::uint32_t> send;      // see GhostLink
  Buffer<std::uint32_t> saved[2];  // both at the last save()
  Travellers out, in;
  Buffer<Travelling> count;      // of each sphere, then summed over all lower indices (n + 1)
  Buffer<std::uint32_t> flag;    // likewise (n + 1)
  Buffer<Travelling> total;      // (1)
  Buffer<std::uint32_t> number;  // a few numbers on their way to the host
  Buffer<std::uint32_t> sent;    // ordinals on their way to other ranks
  Buffer<PlacedWork> work;       // of own spheres, some together

  // For the tangents of all ranks.
  Buffer<NearBody> near;
  Buffer<WallTangent> tangent;
  Buffer<WindowProgress> window;

  template <class F>
  void for_each(F f) const {
    f(ordinal), f(send), f(saved[0]), f(saved[1]), f(out.spheres), f(out.contacts), f(out.walls);
    f(in.spheres), f(in.contacts), f(in.walls), f(count), f(total), f(flag), f(number), f(sent), f(work);
    f(near), f(tangent), f(window);
  }
};

}  // namespace tandem::dem
