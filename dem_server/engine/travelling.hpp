// Spheres and their contacts as they go from rank to rank when lists are rebuilt.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "dem_server/laws/history.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/state/particles.hpp"

namespace tandem::dem {

// Followed by its contacts, those with spheres first.
template <class Real>
struct TravellingSphere {
  PositionRadius<Real> position;
  VelocityKind<Real> velocity;
  Spin<Real> spin;
  FinePart<Real> fine;
  std::uint32_t id = 0, ordinal = 0;      // see RankShare
  std::uint32_t contacts = 0, walls = 0;  // that follow
};
// The sphere with the lower ordinal has the contact.
template <class Real>
struct TravellingContact {
  std::uint32_t with = 0;  // ordinal
  Vec3<Real> spring;
  RollingSpring<Real> rolling;
};
template <class Real>
struct TravellingWall {
  std::uint32_t body = 0, facet = 0;
  History<Real> history;
  RollingSpring<Real> rolling;
};

template <class T>
void put(std::vector<std::byte>& bytes, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* const begin = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), begin, begin + sizeof value);
}
template <class T>
T take(const std::byte*& at) {
  static_assert(std::is_trivially_copyable_v<T>);
  T value;
  std::memcpy(&value, at, sizeof value);
  at += sizeof value;
  return value;
}

}  // namespace tandem::dem
