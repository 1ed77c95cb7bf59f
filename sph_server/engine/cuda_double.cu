#include "sph_server/backend/cuda/exec_cuda.cuh"
#include "sph_server/engine/variant.hpp"

namespace tandem::sph {

std::unique_ptr<LiquidEngine> make_cuda_double(const LiquidSetup& setup);
std::unique_ptr<LiquidEngine> make_cuda_double(const LiquidSetup& setup) {
  return make_variant<CudaExec, double>(setup);
}

}  // namespace tandem::sph
