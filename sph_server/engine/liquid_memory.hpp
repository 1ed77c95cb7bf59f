// The arrays of a liquid with one entry per particle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sph_server/step/arrays.hpp"

namespace tandem::sph {

// Array<T>: std::vector, or a buffer of a back end.
template <template <class> class Array, class Real, bool shifting>
struct LiquidMemory {
  Array<std::uint32_t> number;
  Array<particles::PositionRadius<Real>> position;
  Array<particles::VelocityKind<Real>> velocity;
  Array<particles::FinePart<Real>> fine;
  Array<ParticleState<Real>> state;
  Array<Vec3<Real>> slope, shift;
  Array<float> filled;
  Array<double> compression;
  Array<Vec3d> acceleration[2];
  Array<double> rate[2];

  // Calls visit(name, array of each of `all`), for memories that may have different arrays.
  template <class Visit, class... All>
  static void each(Visit visit, All&... all) {
    visit("number", all.number...);
    visit("position", all.position...);
    visit("velocity", all.velocity...);
    if constexpr (particles::has_fine_part<Real>) visit("fine", all.fine...);
    visit("state", all.state...);
    visit("slope", all.slope...);
    visit("filled", all.filled...);
    if constexpr (shifting) visit("shift", all.shift...);
    visit("compression", all.compression...);
    visit("acceleration", all.acceleration[0]...);
    visit("previous_acceleration", all.acceleration[1]...);
    visit("rate", all.rate[0]...);
    visit("previous_rate", all.rate[1]...);
  }

  LiquidArrays<Real> view(std::size_t count) {
    LiquidArrays<Real> v;
    v.count = static_cast<std::uint32_t>(count);
    v.number = number.data();
    v.position = position.data();
    v.velocity = velocity.data();
    v.fine = fine.data();
    v.state = state.data();
    v.compression = compression.data();
    v.slope = slope.data();
    v.filled = filled.data();
    if constexpr (shifting) v.shift = shift.data();
    for (int side = 0; side < 2; ++side) {
      v.acceleration[side] = acceleration[side].data();
      v.rate[side] = rate[side].data();
    }
    return v;
  }
};

template <class T>
using HostArray = std::vector<T>;
template <class Real, bool shifting>
using HostLiquid = LiquidMemory<HostArray, Real, shifting>;

}  // namespace tandem::sph
