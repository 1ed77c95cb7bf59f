#include "sph_server/engine/liquid_engine.hpp"

#include <numbers>

#include "sph_server/backend/cpu/exec_cpu.hpp"
#include "sph_server/engine/variant.hpp"

namespace tandem::sph {

#if TANDEM_HAS_CUDA
std::unique_ptr<LiquidEngine> make_cuda_mixed(const LiquidSetup& setup);
std::unique_ptr<LiquidEngine> make_cuda_double(const LiquidSetup& setup);
#endif

std::unique_ptr<LiquidEngine> make_liquid_engine(const LiquidSetup& setup, bool single) {
  if (setup.backend == particles::Backend::cuda) {
    particles::choose_backend("cuda");
#if TANDEM_HAS_CUDA
    return single ? make_cuda_mixed(setup) : make_cuda_double(setup);
#endif
  }
  return single ? make_variant<CpuExec, float>(setup) : make_variant<CpuExec, double>(setup);
}

namespace {

template <class Real>
std::size_t bytes_of_particle(bool shifting) {
  return sizeof(particles::PositionRadius<Real>) + sizeof(particles::VelocityKind<Real>) +
         (particles::has_fine_part<Real> ? sizeof(particles::FinePart<Real>) : 0) +
         sizeof(ParticleState<Real>) + (shifting ? 2 : 1) * sizeof(Vec3<Real>) + sizeof(float) +
         3 * sizeof(double) +  // compression, and its rate in two steps
         2 * sizeof(Vec3d) +   // acceleration in two steps
         sizeof(Vec3d);        // position when the lists were built
}
template <class Real>
std::size_t bytes_of_sums(bool shifting) {
  return shifting ? sizeof(PairSums<Real, true>) : sizeof(PairSums<Real, false>);
}

}  // namespace

std::size_t predicted_bytes(std::size_t particles, const LiquidSetup& setup, bool single, bool with_copy) {
  const Liquid& liquid = setup.liquid;
  const double reach =
                   liquid.support() / liquid.spacing + 0.5 * widest_skin,  // of slow and of fast particles
      neighbours = 4.0 / 3 * std::numbers::pi * reach * reach * reach;
  // On a CPU the parts of the threads are there as well while a list is built; a GPU has room for an eighth.
  const double list =
      neighbours * sizeof(Neighbour) * (setup.backend == particles::Backend::cuda ? 1.125 : 2);
  // Starts of lists, the sort into cells, clearances, the next positions, viewpoints and accelerations beside
  // walls.
  const double others = 7 * sizeof(std::uint32_t) + sizeof(float) + 3 * sizeof(Vec3d);
  const bool shifting = liquid.shifting > 0;
  const auto particle =
      static_cast<double>(single ? bytes_of_particle<float>(shifting) : bytes_of_particle<double>(shifting));
  const auto sums =
      static_cast<double>(single ? bytes_of_sums<float>(shifting) : bytes_of_sums<double>(shifting));
  const double copies = with_copy ? 2 : 1;
  return static_cast<std::size_t>(static_cast<double>(particles) *
                                  (copies * particle + list + others + sums));
}

}  // namespace tandem::sph
