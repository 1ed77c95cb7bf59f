# Sets TANDEM_HAS_CUDA. nvcc is looked for on PATH and in /usr/local/cuda.
set(TANDEM_HAS_CUDA OFF)
if(NOT TANDEM_CUDA STREQUAL "OFF")
  find_program(TANDEM_NVCC nvcc HINTS /usr/local/cuda/bin)
  if(TANDEM_NVCC)
    set(CMAKE_CUDA_COMPILER ${TANDEM_NVCC})
    # sm_80 and sm_90 machine code, and PTX of the newest for what comes after.
    set(CMAKE_CUDA_ARCHITECTURES "80-real;90a-real;90-virtual" CACHE STRING "")
    set(CMAKE_CUDA_RUNTIME_LIBRARY Static)
    enable_language(CUDA)
    # CMake 3.25 does not know how nvcc 13 is told to speak C++20.
    if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)
      set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
      set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
    endif()
    find_package(CUDAToolkit REQUIRED)
    set(TANDEM_HAS_CUDA ON)
  elseif(TANDEM_CUDA STREQUAL "ON")
    message(FATAL_ERROR "TANDEM_CUDA=ON, but nvcc is neither on PATH nor in /usr/local/cuda/bin; "
                        "install the CUDA toolkit or configure with TANDEM_CUDA=OFF")
  endif()
endif()
message(STATUS "tandem: CUDA back end ${TANDEM_HAS_CUDA}")
