// The engine of a liquid on the back end that a program tests.
#pragma once

#include <memory>
#include <vector>

#include "sph_server/engine/fill_region.hpp"
#include "sph_server/engine/liquid_engine.hpp"
#include "tests/support/tested_backend.hpp"

namespace tandem::test {

inline std::unique_ptr<sph::LiquidEngine> make_engine(sph::LiquidSetup setup, bool single) {
  setup.backend = tested_backend();
  return sph::make_liquid_engine(setup, single);
}

// fill_region() on the same back end.
inline sph::LiquidState fill(sph::LiquidSetup setup, const std::vector<particles::BodyPose>& poses,
                             const TriangleMesh& region, const sph::FillAmount& amount) {
  setup.backend = tested_backend();
  return sph::fill_region(setup, poses, {region, amount});
}

}  // namespace tandem::test
