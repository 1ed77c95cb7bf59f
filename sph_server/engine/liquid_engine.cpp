#include "sph_server/engine/liquid_engine.hpp"

#include <numbers>

#include "sph_server/engine/exchange.hpp"
#include "sph_server/engine/state_copies.hpp"

namespace tandem::sph {

std::unique_ptr<LiquidEngine> make_liquid_engine(const LiquidSetup& setup, bool single) {
  const bool shifting = setup.liquid.shifting > 0;
  if (single && shifting) return std::make_unique<LiquidEngineOf<float, true>>(setup);
  if (single) return std::make_unique<LiquidEngineOf<float, false>>(setup);
  if (shifting) return std::make_unique<LiquidEngineOf<double, true>>(setup);
  return std::make_unique<LiquidEngineOf<double, false>>(setup);
}

template <class Real>
std::size_t bytes_of_particle(bool shifting) {
  return sizeof(particles::PositionRadius<Real>) + sizeof(particles::VelocityKind<Real>) +
         sizeof(particles::FinePart<Real>) + sizeof(ParticleState<Real>) +
         (shifting ? 2 : 1) * sizeof(Vec3<Real>) +
         3 * sizeof(double) +  // compression, and its rate in two steps
         2 * sizeof(Vec3d) +   // acceleration in two steps
         2 * sizeof(Vec3d);    // position when the list was built, and a copy while it is
}

std::size_t predicted_bytes(std::size_t particles, const Liquid& liquid, bool single, bool with_copy) {
  const double reach = liquid.support() / liquid.spacing + list_skin,
               neighbours = 4.0 / 3 * std::numbers::pi * reach * reach * reach;
  // While a list is built, the parts of its threads are there as well.
  const double list = sizeof(std::uint32_t) + neighbours * sizeof(Neighbour);
  const bool shifting = liquid.shifting > 0;
  const auto particle =
      static_cast<double>(single ? bytes_of_particle<float>(shifting) : bytes_of_particle<double>(shifting));
  const double copies = with_copy ? 2 : 1;
  return static_cast<std::size_t>(static_cast<double>(particles) * (copies * (particle + list) + list));
}

}  // namespace tandem::sph
