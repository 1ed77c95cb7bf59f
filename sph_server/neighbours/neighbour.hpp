// One entry of a list of neighbours.
#pragma once

#include <cstdint>

#include "common/host_device.hpp"
#include "particles/geometry/periods.hpp"

namespace tandem::sph {

// A neighbour and the period by which it is shifted: 26 bits of index, 6 bits of particles::Image.
class Neighbour {
 public:
  static constexpr std::uint32_t most = 1u << 26;
  Neighbour() = default;
  TANDEM_HD Neighbour(std::uint32_t index, particles::Image image)
      : word_(std::uint32_t{image} << 26 | index) {}
  TANDEM_HD std::uint32_t index() const { return word_ & (most - 1); }
  TANDEM_HD particles::Image image() const { return static_cast<particles::Image>(word_ >> 26); }

 private:
  std::uint32_t word_ = 0;
};

}  // namespace tandem::sph
