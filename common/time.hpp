// Time at the coupling interface is an integer count of nanoseconds since the start of the run;
// inside a step it is a double in seconds. Conversions are here and nowhere else.
#pragma once

#include <cmath>
#include <cstdint>

namespace tandem {

struct Nanoseconds {
  std::int64_t count = 0;
  friend constexpr auto operator<=>(Nanoseconds, Nanoseconds) = default;
  friend constexpr Nanoseconds operator+(Nanoseconds a, Nanoseconds b) { return {a.count + b.count}; }
  friend constexpr Nanoseconds operator-(Nanoseconds a, Nanoseconds b) { return {a.count - b.count}; }
};

inline Nanoseconds to_nanoseconds(double seconds) {
  return {std::llround(seconds * 1e9)};
}
// Divided, because 1e9 is exact in binary and 1e-9 is not: 1'000'000'000'000 ns are 1000 s to the last bit.
constexpr double to_seconds(Nanoseconds t) {
  return static_cast<double>(t.count) / 1e9;
}

// A coupling window [begin, end]; index counts accepted windows from 0.
struct Window {
  std::uint64_t index = 0;
  Nanoseconds begin, end;
  double length() const { return to_seconds(end - begin); }  // [s]
};

}  // namespace tandem
