// Centre and velocity of a sphere in full resolution; other spheres read them rounded. With Real = float:
//
//   a coordinate is a 64-bit number, of which PositionRadius holds 32 bits and FinePart the others
//
//     | multiples of 2^32 quanta | PositionRadius | parts of a quantum |
//
//   a velocity component is the sum of two floats, one in VelocityKind and one in FinePart: 48 bits
//
// Rounding moves a coordinate by at most half a part per step, wherever the sphere is: by some 1e-15 radii,
// or in a vast domain by 4e-18 of its extent. With Real = double, PositionRadius and VelocityKind hold the
// full resolution.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "particles/base/arithmetic.hpp"
#include "particles/base/fixed_point.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/state/particles.hpp"

namespace tandem::particles {

template <class Real>
struct CentreUnit;

template <>
struct CentreUnit<float> {
  using Centre = Vec3<std::int64_t>;  // in parts of a quantum
  Quantum part;                       // [m]
  std::uint32_t part_bits = 0;        // a quantum has 2^part_bits parts
  std::uint32_t part_mask = 0;        // selects these bits

  static constexpr int most_part_bits = 20;
  // The number of parts that leaves room for coordinates of 2^spare_bits times `farthest` [m]. If even whole
  // quanta leave too little room, range() is less than that.
  static CentreUnit for_range(LengthUnit<float> unit, double farthest, int spare_bits) {
    int exponent = 0, quantum = 0;
    std::frexp(farthest, &exponent);
    std::frexp(unit.size, &quantum);
    const int bits = std::clamp(61 - spare_bits - exponent + (quantum - 1), 0, most_part_bits);
    return {{std::ldexp(static_cast<double>(unit.size), -bits), std::ldexp(unit.inverse, bits)},
            static_cast<std::uint32_t>(bits),
            (1u << bits) - 1u};
  }
  double range() const { return std::ldexp(part.size, 61); }  // [m]

  TANDEM_HD Centre of(Vec3d x) const {
    return {to_fixed(x.x, part), to_fixed(x.y, part), to_fixed(x.z, part)};
  }
  TANDEM_HD Vec3d metres(Centre c) const {
    return {from_fixed(c.x, part), from_fixed(c.y, part), from_fixed(c.z, part)};
  }
  TANDEM_HD Centre joined(const PositionRadius<float>& position, const FinePart<float>& fine) const {
    return {joined(position.x, fine.fine_position.x), joined(position.y, fine.fine_position.y),
            joined(position.z, fine.fine_position.z)};
  }
  TANDEM_HD void split(Centre c, PositionRadius<float>& position, FinePart<float>& fine) const {
    position.x = placed(c.x);
    position.y = placed(c.y);
    position.z = placed(c.z);
    fine.fine_position = {left(c.x), left(c.y), left(c.z)};
  }
  // Centre moved into the domain by whole periods, which are whole quanta.
  TANDEM_HD Centre wrapped(Centre c, const Periods& periods) const {
    const Centre min = of(periods.min), length = of(periods.length);
    for (int a = 0; a < 3; ++a) {
      if (length[a] == 0) continue;
      const std::int64_t beyond = (c[a] - min[a]) % length[a];
      c[a] = min[a] + (beyond < 0 ? beyond + length[a] : beyond);
    }
    return c;
  }

 private:
  TANDEM_HD std::int64_t joined(std::int32_t position, std::uint32_t fine) const {
    const std::uint64_t above = std::uint64_t{fine & ~part_mask} << 32,
                        within = std::uint64_t{static_cast<std::uint32_t>(position)} << part_bits;
    return static_cast<std::int64_t>(above | within | (fine & part_mask));
  }
  TANDEM_HD std::int32_t placed(std::int64_t c) const {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint64_t>(c) >> part_bits));
  }
  TANDEM_HD std::uint32_t left(std::int64_t c) const {
    const auto bits = static_cast<std::uint64_t>(c);
    return (static_cast<std::uint32_t>(bits >> 32) & ~part_mask) |
           (static_cast<std::uint32_t>(bits) & part_mask);
  }
};

template <>
struct CentreUnit<double> {
  using Centre = Vec3d;  // [m]
  static CentreUnit for_range(LengthUnit<double>, double, int) { return {}; }
  double range() const { return HUGE_VAL; }

  TANDEM_HD Centre of(Vec3d x) const { return x; }
  TANDEM_HD Vec3d metres(Centre c) const { return c; }
  TANDEM_HD Centre joined(const PositionRadius<double>& position, const FinePart<double>&) const {
    return {position.x, position.y, position.z};
  }
  TANDEM_HD void split(Centre c, PositionRadius<double>& position, FinePart<double>&) const {
    position.x = c.x;
    position.y = c.y;
    position.z = c.z;
  }
  TANDEM_HD Centre wrapped(Centre c, const Periods& periods) const { return periods.wrapped(c); }
};

template <class Real>
TANDEM_HD Vec3d velocity_of(const VelocityKind<Real>& velocity, [[maybe_unused]] const FinePart<Real>& fine) {
  const Vec3d v = velocity.v.template as<double>();
  if constexpr (has_fine_part<Real>)
    return v + fine.fine_velocity.template as<double>();
  else
    return v;
}
template <class Real>
TANDEM_HD void set_velocity(Vec3d v, VelocityKind<Real>& velocity, [[maybe_unused]] FinePart<Real>& fine) {
  if constexpr (has_fine_part<Real>) {
    const Vec3d single{nearest_single(v.x), nearest_single(v.y), nearest_single(v.z)};
    fine.fine_velocity = (v - single).as<float>();
    velocity.v = single.as<float>();
  } else {
    velocity.v = v;
  }
}

}  // namespace tandem::particles
