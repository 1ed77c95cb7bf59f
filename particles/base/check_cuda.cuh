// Failed calls of the CUDA runtime become errors.
#pragma once

#include <cuda_runtime.h>

#include <string>

#include "common/error.hpp"

namespace tandem::particles {

inline void check_cuda(cudaError_t status, const char* doing) {
  if (status != cudaSuccess)
    throw Error(ErrorCode::resource, std::string(cudaGetErrorString(status)) + " while " + doing,
                "CUDA device",
                status == cudaErrorMemoryAllocation ? "use fewer particles or --backend cpu" : "");
}

}  // namespace tandem::particles
