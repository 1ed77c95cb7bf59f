// Marks functions that both the host compiler and nvcc compile. No CUDA header is needed.
#pragma once

#if defined(__CUDACC__)
#define TANDEM_HD __host__ __device__
#else
#define TANDEM_HD
#endif
