// Colours of the pictures. Both sets of distinct colours stay apart for readers who are colour-blind: those
// of bodies are [OkabeIto2008], those of groups of spheres the muted ones of [Tol2021].
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "common/math/vec3.hpp"

namespace tandem::launch {

// sRGB, each from 0 to 1. Seven hues; from the eighth on darker ones, then paler ones.
Vec3d body_colour(std::size_t index);
Vec3d group_colour(std::size_t index);  // nine hues, then again from the first

// `share` of a colour bar, from 0 to 1: its lightness rises with the share.
Vec3d bar_colour(double share);

// What the colours of the spheres mean.
struct ColourScale {
  std::string title = {};               // with the unit
  double low = 0, high = 1;             // ends of the colour bar
  bool exceeded = false;                // some values are above `high`
  std::vector<std::string> names = {};  // of values that are indices: a legend in place of a colour bar

  Vec3d colour(double value) const;
};

// Ends of a colour bar for the values that are added, one frame after the other.
class ScaleRange {
 public:
  void add(std::span<const double> values);
  // From zero to a value that 99 of 100 spheres do not exceed in any frame, or from the smallest value to the
  // largest.
  ColourScale from_zero(const std::string& title) const;
  ColourScale whole(const std::string& title) const;

 private:
  double low_ = 1e300, high_ = -1e300, most_ = 0;
};

// Values for the ticks of a colour bar: multiples of 1, 2 or 5 times a power of ten, within the ends.
std::vector<double> ticks(double low, double high);

}  // namespace tandem::launch
