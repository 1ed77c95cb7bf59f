// Vectors in space of numbers or of dual numbers (spatial/dual.hpp).
#pragma once

#include <array>

#include "mbd_server/spatial/dual.hpp"
#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

template <class T>
using Triple = std::array<T, 3>;

template <class T>
T dot(const Triple<T>& a, const Triple<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
Triple<T> cross(const Triple<T>& a, const Triple<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
Triple<T> scaled(const T& s, const Triple<T>& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
template <class T>
Triple<T> sum(const Triple<T>& a, const Triple<T>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class T>
Triple<T> difference(const Triple<T>& a, const Triple<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
Vector3d numbers(const Triple<T>& a) {
  return {value_of(a[0]), value_of(a[1]), value_of(a[2])};
}
template <class T>
Triple<T> triple(const Vector3d& a) {
  return {T(a.x()), T(a.y()), T(a.z())};
}

}  // namespace tandem::mbd
