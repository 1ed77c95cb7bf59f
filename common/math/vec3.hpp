// Three-vector for host and device.
#pragma once

#include <cmath>

#include "common/host_device.hpp"

namespace tandem {

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  TANDEM_HD constexpr T& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
  TANDEM_HD constexpr T operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }

  TANDEM_HD constexpr Vec3& operator+=(Vec3 b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  TANDEM_HD constexpr Vec3& operator-=(Vec3 b) {
    x -= b.x;
    y -= b.y;
    z -= b.z;
    return *this;
  }
  TANDEM_HD constexpr Vec3& operator*=(T s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }

  TANDEM_HD friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  TANDEM_HD friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  TANDEM_HD friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  TANDEM_HD friend constexpr Vec3 operator*(T s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
  TANDEM_HD friend constexpr Vec3 operator*(Vec3 a, T s) { return s * a; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;

  template <class U>
  TANDEM_HD constexpr Vec3<U> as() const {
    return {static_cast<U>(x), static_cast<U>(y), static_cast<U>(z)};
  }
};

using Vec3d = Vec3<double>;
using Vec3f = Vec3<float>;

template <class T>
TANDEM_HD constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
TANDEM_HD constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
TANDEM_HD constexpr T norm2(Vec3<T> a) {
  return dot(a, a);
}
template <class T>
TANDEM_HD T norm(Vec3<T> a) {
  using std::sqrt;
  return sqrt(norm2(a));
}
template <class T>
TANDEM_HD Vec3<T> normalized(Vec3<T> a) {
  return (T(1) / norm(a)) * a;
}
template <class T>
bool is_finite(Vec3<T> a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace tandem
