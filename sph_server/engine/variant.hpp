// The engines of one back end.
#pragma once

#include "sph_server/engine/cell_order.hpp"
#include "sph_server/engine/exchange.hpp"
#include "sph_server/engine/lists.hpp"
#include "sph_server/engine/lost.hpp"
#include "sph_server/engine/measured.hpp"
#include "sph_server/engine/state_copies.hpp"

namespace tandem::sph {

template <class Exec, class Real>
std::unique_ptr<LiquidEngine> make_variant(const LiquidSetup& setup) {
  if (setup.liquid.shifting > 0) return std::make_unique<LiquidEngineOf<Exec, Real, true>>(setup);
  return std::make_unique<LiquidEngineOf<Exec, Real, false>>(setup);
}

}  // namespace tandem::sph
