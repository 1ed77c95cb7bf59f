// Distance of two spheres. Everything before the square root is exact for Real = float, because an overlap is
// the small difference of large numbers.
#pragma once

#include "dem_server/laws/particle_names.hpp"
#include "particles/base/arithmetic.hpp"
#include "particles/state/particles.hpp"

namespace tandem::dem {

// Two spheres in contact, in counts of LengthUnit.
template <class Real>
struct Separation {
  Vec3<Real> d;     // from the neighbour's centre to the own centre
  Real d2 = 0;      // |d|^2
  Real reach = 0;   // sum of the radii
  Real depth2 = 0;  // reach^2 - d2
};

// n: unit normal from the neighbour to the own sphere [-]; returns the overlap [m]. reach - distance is
// (reach^2 - d2) / (reach + distance), without cancellation; the overlap and n share one division.
template <class Real>
TANDEM_HD Real overlap_of(const Separation<Real>& s, LengthUnit<Real> unit, Vec3<Real>& n) {
  const Real distance = root(s.d2), sum = s.reach + distance;
  const Real inverse = reciprocal(distance * sum);
  n = (inverse * sum) * s.d;
  return unit.size * (s.depth2 * (inverse * distance));
}

template <class Real>
struct Approach;

template <>
struct Approach<float> {
  std::int32_t d[3];   // from the neighbour's centre to the own centre [quanta]
  std::int64_t d2;     // |d|^2
  std::int64_t reach;  // sum of the radii, or 0 where one is parked

  // `margin` widens the reach.
  TANDEM_HD Approach(const PositionRadius<float>& own, const PositionRadius<float>& other,
                     std::int32_t margin = 0)
      : d{minus(own.x, other.x), minus(own.y, other.y), minus(own.z, other.z)},
        d2(static_cast<std::int64_t>(unsigned64(d[0]) + unsigned64(d[1]) + unsigned64(d[2]))) {
    const std::int32_t sum = own.radius + other.radius + margin;
    reach = sum > 0 ? sum : 0;
  }
  // Valid only at the distances of listed neighbours. Two spheres at one point are not in contact, because
  // their contact has no normal; the start of a run is checked for such pairs.
  TANDEM_HD bool touching() const { return d2 < reach * reach && d2 != 0; }
  // touching() for spheres at any distance. |d|^2 may then exceed 63 bits.
  TANDEM_HD static bool near(const PositionRadius<float>& own, const PositionRadius<float>& other,
                             std::int32_t margin) {
    const std::int32_t sum = own.radius + other.radius + margin;
    const auto reach = static_cast<std::uint64_t>(sum > 0 ? sum : 0);
    const std::uint64_t d2 = unsigned64(minus(own.x, other.x)) + unsigned64(minus(own.y, other.y)) +
                             unsigned64(minus(own.z, other.z));
    return d2 < reach * reach && d2 != 0;
  }

  // True for all pairs in contact and for few others, at a third of the cost: in units of 2^15 quanta, where
  // rounding moves the distance by at most sqrt(3) and the reach by 1.
  TANDEM_HD static bool may_touch(const PositionRadius<float>& own, const PositionRadius<float>& other,
                                  std::int32_t margin = 0) {
    const std::int32_t sum = own.radius + other.radius + margin;
    const std::uint32_t reach = (static_cast<std::uint32_t>(sum > 0 ? sum : 0) >> 15) + 3;
    return square32(minus(own.x, other.x) >> 15) + square32(minus(own.y, other.y) >> 15) +
               square32(minus(own.z, other.z) >> 15) <
           reach * reach;
  }

  // Also called for spheres that are not in contact, where computing with the result is cheaper than waiting
  // for the comparison (contact/pair_forces.hpp). Those get a depth of one quantum, so that all square roots
  // exist.
  TANDEM_HD Separation<float> separation() const {
    const float depth2 = static_cast<float>(reach * reach - d2);
    return {{static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])},
            static_cast<float>(d2),
            static_cast<float>(static_cast<std::int32_t>(reach)),  // fits into 32 bits
            depth2 > 1 ? depth2 : 1.0F};
  }

 private:
  TANDEM_HD static std::int32_t minus(std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
  }
  TANDEM_HD static std::int64_t square64(std::int32_t a) { return static_cast<std::int64_t>(a) * a; }
  TANDEM_HD static std::uint64_t unsigned64(std::int32_t a) {
    return static_cast<std::uint64_t>(square64(a));
  }
  TANDEM_HD static std::uint32_t square32(std::int32_t a) {
    return static_cast<std::uint32_t>(a) * static_cast<std::uint32_t>(a);
  }
};

template <>
struct Approach<double> {
  Vec3d d;  // [m]
  double d2, reach;

  TANDEM_HD Approach(const PositionRadius<double>& own, const PositionRadius<double>& other,
                     double margin = 0)
      : d{own.x - other.x, own.y - other.y, own.z - other.z}, d2(norm2(d)) {
    const double sum = own.radius + other.radius + margin;
    reach = sum > 0 ? sum : 0;
  }
  TANDEM_HD bool touching() const { return d2 < reach * reach && d2 != 0; }
  TANDEM_HD static bool near(const PositionRadius<double>& own, const PositionRadius<double>& other,
                             double margin) {
    return Approach(own, other, margin).touching();
  }
  TANDEM_HD static bool may_touch(const PositionRadius<double>& own, const PositionRadius<double>& other,
                                  double margin = 0) {
    return Approach(own, other, margin).touching();
  }

  TANDEM_HD Separation<double> separation() const { return {d, d2, reach, reach * reach - d2}; }
};

}  // namespace tandem::dem
