// Marks functions that both the host compiler and nvcc compile. No CUDA header is needed.
#pragma once

#if defined(__CUDACC__)
#define TANDEM_HD __host__ __device__
// For a loop of few iterations, whose unrolled copies would only fill a GPU's instruction cache.
#define TANDEM_ROLLED _Pragma("unroll 1")
#else
#define TANDEM_HD
#define TANDEM_ROLLED
#endif
