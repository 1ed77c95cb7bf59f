#include "sph_server/backend/cuda/exec_cuda.cuh"
#include "sph_server/engine/variant.hpp"

namespace tandem::sph {

std::unique_ptr<LiquidEngine> make_cuda_mixed(const LiquidSetup& setup);
std::unique_ptr<LiquidEngine> make_cuda_mixed(const LiquidSetup& setup) {
  return make_variant<CudaExec, float>(setup);
}

}  // namespace tandem::sph
