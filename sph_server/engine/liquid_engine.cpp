#include "sph_server/engine/liquid_engine.hpp"

#include "sph_server/engine/liquid_engine_of.hpp"

namespace tandem::sph {

std::unique_ptr<LiquidEngine> make_liquid_engine(const LiquidSetup& setup, bool single) {
  if (single) return std::make_unique<LiquidEngineOf<float>>(setup);
  return std::make_unique<LiquidEngineOf<double>>(setup);
}

}  // namespace tandem::sph
