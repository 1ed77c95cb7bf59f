// The arrays of the spheres, as plain pointers that are valid on the processor that runs them. [2]: double
// buffered; StepProgress::state_side is the current side.
#pragma once

#include <cstdint>

#include "particles/base/range.hpp"
#include "particles/state/particles.hpp"

namespace tandem::particles {

template <class Real>
struct SphereArrays {
  std::uint32_t count = 0;              // indices in use, parked ones included
  Range owned;                          // those that this rank moves; the others are ghosts, see Ranks
  PositionRadius<Real>* position[2]{};  // (count)
  VelocityKind<Real>* velocity[2]{};    // (count)
  Spin<Real>* spin[2]{};                // (count); absent for laws without friction
  FinePart<Real>* fine = nullptr;       // (count); absent in double precision
  // Number at the start; undefined for parked indices. Absent where Spin has it (count)
  std::uint32_t* id = nullptr;

  TANDEM_HD bool owns(std::uint32_t i) const { return i - owned.begin < owned.end - owned.begin; }
  TANDEM_HD FinePart<Real> fine_part(std::uint32_t i) const {
    if constexpr (has_fine_part<Real>)
      return fine[i];
    else
      return {};
  }
};

}  // namespace tandem::particles
