// Marks functions that both the host compiler and nvcc compile. No CUDA header is needed.
#pragma once

#if defined(__CUDACC__)
#define TANDEM_HD __host__ __device__
// For rare work inside a kernel: inlined, its registers would be reserved by every thread.
#define TANDEM_NOINLINE __noinline__
#else
#define TANDEM_HD
#define TANDEM_NOINLINE
#endif
