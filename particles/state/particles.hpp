// The state of the spheres, split by its readers.
//
//   PositionRadius   centre, radius             read by every candidate neighbour
//   VelocityKind     velocity, kind, label      read by neighbours in contact; the label refers to walls
//   Spin             angular velocity, id       read by neighbours in contact, for laws with friction
//   FinePart         rest of centre, velocity   read by the sphere itself
//
// Neighbours need differences of positions, for which absolute positions in single precision are too coarse:
// overlaps are 1e-4 radii, and at 1 m from the origin a single-precision coordinate resolves 6e-8 m. With
// Real = float a PositionRadius therefore counts quanta of length modulo 2^32: the difference of two
// neighbours is exact as long as it is below 2^31 quanta, wherever they are. The motion of a sphere needs a
// finer resolution, so that a grain that creeps 1e-15 m per step still moves: state/centre.hpp.
//
// PositionRadius, VelocityKind and Spin are double buffered: a step reads one side and writes the other, so
// that no sphere reads a partly updated neighbour.
#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "common/math/vec3.hpp"

namespace tandem::particles {

// The unit in which lengths are counted: metres are count * size.
template <class Real>
struct LengthUnit;

template <class Real>
struct PositionRadius;

template <>
struct alignas(16) PositionRadius<float> {
  std::int32_t x = 0, y = 0, z = 0;  // centre, modulo 2^32 [quanta]
  std::int32_t radius = 0;           // [quanta]
};

template <>
struct alignas(16) PositionRadius<double> {
  double x = 0, y = 0, z = 0;  // centre [m]
  double radius = 0;           // [m]
};

template <>
struct LengthUnit<float> {
  using Count = std::int32_t;
  float size = 1;      // a power of two, so that scaling is exact [m]
  double inverse = 1;  // [1/m]

  // The finest quantum that keeps lengths up to `largest` [m] below 2^30, so that twice these lengths can
  // still be distinguished from negative ones.
  static LengthUnit for_lengths(double largest) {
    int exponent = 0;
    std::frexp(largest, &exponent);
    return {std::ldexp(1.0F, exponent - 30), std::ldexp(1.0, 30 - exponent)};
  }
  TANDEM_HD std::int32_t count(double length) const {
#if defined(__CUDA_ARCH__)
    const std::int64_t nearest = __double2ll_rn(length * inverse);
#else
    const std::int64_t nearest = std::llrint(length * inverse);
#endif
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(nearest));
  }
  // Modulo 2^32, as positions are counted.
  TANDEM_HD static std::int32_t minus(std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
  }
  TANDEM_HD float metres(std::int32_t count) const {
    return static_cast<float>(count) * size;
  }
  TANDEM_HD double exact_metres(std::int32_t count) const {
    return static_cast<double>(count) * static_cast<double>(size);
  }
};

template <>
struct LengthUnit<double> {
  using Count = double;
  static constexpr double size = 1;  // [m]
  static LengthUnit for_lengths(double) { return {}; }
  TANDEM_HD double count(double length) const { return length; }
  TANDEM_HD static double minus(double a, double b) { return a - b; }
  TANDEM_HD double metres(double count) const { return count; }
  TANDEM_HD double exact_metres(double count) const { return count; }
};

// A sphere's kind, see Parameters::kinds, and the bodies near it: entries of ContactLists::near from
// near_first() on.
class Label {
 public:
  static constexpr std::uint32_t kinds = 8, counted = 31, most_near = 1u << 24;

  TANDEM_HD static Label of_kind(std::uint32_t kind) {
    Label b;
    b.word_ = kind;
    return b;
  }
  TANDEM_HD std::uint32_t kind() const { return word_ % kinds; }
  TANDEM_HD std::uint32_t near_first() const { return word_ >> 8; }
  // The value `counted` means that many or more.
  TANDEM_HD std::uint32_t near_count() const { return word_ / kinds % (counted + 1); }
  TANDEM_HD void set_near(std::uint32_t first, std::uint32_t count) {
    word_ = first << 8 | (count < counted ? count : counted) * kinds | kind();
  }

 private:
  std::uint32_t word_ = 0;
};

template <class Real>
struct alignas(4 * sizeof(Real)) VelocityKind {
  Vec3<Real> v;  // velocity [m/s]; leapfrog: half a step before the position
  Label label;

  TANDEM_HD std::uint32_t kind() const { return label.kind(); }
};

template <class Real>
struct alignas(4 * sizeof(Real)) Spin {
  Vec3<Real> w;          // [rad/s]
  std::uint32_t id = 0;  // see SphereArrays::id
};

// See state/centre.hpp.
template <class Real>
struct FinePart;

template <>
struct FinePart<float> {
  Vec3<std::uint32_t>
      fine_position;    // per coordinate: the bits above those of PositionRadius, and those below
  Vec3f fine_velocity;  // full velocity minus that in VelocityKind [m/s]
};

template <>
struct FinePart<double> {};
template <class Real>
inline constexpr bool has_fine_part = !std::is_empty_v<FinePart<Real>>;

// The radius at an index that holds no sphere, which is called parked: nothing touches it. A sphere that has
// left the domain is parked at its index until another sphere takes over the index. Indices that were never
// used are parked, too.
template <class Real>
inline constexpr typename LengthUnit<Real>::Count parked_radius = -(std::int32_t{1} << 30);
template <class Real>
TANDEM_HD bool is_parked(const PositionRadius<Real>& s) {
  return s.radius < 0;
}

// Spheres on the host, in order of id.
struct Spheres {
  std::vector<Vec3d> position;          // [m] (n x 3)
  std::vector<Vec3d> velocity;          // [m/s] (n x 3)
  std::vector<Vec3d> spin;              // [rad/s] (n x 3)
  std::vector<double> radius;           // [m] (n)
  std::vector<std::uint32_t> material;  // (n)
  std::vector<std::uint32_t> id;        // (n)
  std::size_t waiting = 0;              // this many at the end enter the domain later
  std::size_t size() const { return id.size(); }
};

}  // namespace tandem::particles
