// The engine of a liquid on the back end that a program tests.
#pragma once

#include <memory>

#include "sph_server/engine/liquid_engine.hpp"
#include "tests/support/tested_backend.hpp"

namespace tandem::test {

inline std::unique_ptr<sph::LiquidEngine> make_engine(sph::LiquidSetup setup, bool single) {
  setup.backend = tested_backend();
  return sph::make_liquid_engine(setup, single);
}

}  // namespace tandem::test
