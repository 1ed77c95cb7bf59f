// Marks functions that both the host compiler and nvcc compile. No CUDA header is needed.
#pragma once

#if defined(__CUDACC__)
#define TANDEM_HD __host__ __device__
// Before a loop of few rounds, whose copies would only fill a GPU's cache of instructions.
#define TANDEM_ROLLED _Pragma("unroll 1")
#else
#define TANDEM_HD
#define TANDEM_ROLLED
#endif
