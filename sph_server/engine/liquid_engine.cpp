#include "sph_server/engine/liquid_engine.hpp"

#include "sph_server/engine/liquid_engine_of.hpp"

namespace tandem::sph {

std::unique_ptr<LiquidEngine> make_liquid_engine(const LiquidSetup& setup, bool single) {
  const bool shifting = setup.liquid.shifting > 0;
  if (single && shifting) return std::make_unique<LiquidEngineOf<float, true>>(setup);
  if (single) return std::make_unique<LiquidEngineOf<float, false>>(setup);
  if (shifting) return std::make_unique<LiquidEngineOf<double, true>>(setup);
  return std::make_unique<LiquidEngineOf<double, false>>(setup);
}

}  // namespace tandem::sph
