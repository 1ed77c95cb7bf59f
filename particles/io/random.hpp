// Random numbers that are the same on every machine.
#pragma once

#include <cstdint>

namespace tandem::particles {

// splitmix64 [Steele2014]; the generators of std:: differ between libraries.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  double uniform(double low, double high) {  // [low, high)
    return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1p-53);
  }

  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return z;
  }

 private:
  std::uint64_t state_;
};

}  // namespace tandem::particles
