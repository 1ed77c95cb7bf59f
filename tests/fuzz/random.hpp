// Random numbers that are the same on every machine, from a seed and the number of an input.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tandem::fuzz {

// splitmix64, [Steele2014].
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t number) : state_(seed * 0xd1342543de82ef95u + number) { bits(); }

  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  // A number from 0 to n - 1; n > 0. The bias of the modulo does not matter here.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(bits() % n); }
  bool one_in(std::size_t n) { return below(n) == 0; }

 private:
  std::uint64_t state_;
};

}  // namespace tandem::fuzz
