# Sets TANDEM_HAS_CUDA. nvcc is looked for on PATH and in /usr/local/cuda. AUTO compiles the kernels only where they can run: they
# take as long as half of the product.
set(TANDEM_HAS_CUDA OFF)
set(TANDEM_CUDA_REASON "TANDEM_CUDA=OFF")
if(TANDEM_CUDA STREQUAL "AUTO" AND NOT EXISTS /dev/nvidiactl)
  set(TANDEM_CUDA_REASON "no NVIDIA device on this machine; the preset 'cuda' builds it all the same")
elseif(NOT TANDEM_CUDA STREQUAL "OFF")
  set(TANDEM_CUDA_REASON "no nvcc on PATH or in /usr/local/cuda/bin")
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
if(TANDEM_HAS_CUDA)
  message(STATUS "tandem: CUDA back end ON, ${TANDEM_NVCC}")
else()
  message(STATUS "tandem: CUDA back end OFF: ${TANDEM_CUDA_REASON}")
endif()

# tandem_cuda_sources(TARGET SOURCE... HOST SOURCE...): kernels and the code that starts them, as part of TARGET where the CUDA back end
# is built. HOST: sources of TARGET that differ in such a build. The target `kernels` compiles those of all targets and nothing else.
add_custom_target(kernels)
function(tandem_cuda_sources target)
  if(NOT TANDEM_HAS_CUDA)
    return()
  endif()
  cmake_parse_arguments(PARSE_ARGV 1 of "" "" HOST)
  add_library(${target}_kernels OBJECT ${of_UNPARSED_ARGUMENTS})
  add_library(${target}_host OBJECT EXCLUDE_FROM_ALL ${of_HOST})
  foreach(part ${target}_kernels ${target}_host)
    tandem_target(${part})
    target_link_libraries(${part} PRIVATE $<TARGET_PROPERTY:${target},LINK_LIBRARIES>)
    target_include_directories(${part} PRIVATE $<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>)
    target_compile_definitions(${part} PRIVATE $<TARGET_PROPERTY:${target},COMPILE_DEFINITIONS>)
    add_dependencies(kernels ${part})
  endforeach()
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_kernels>)
  # Without fused multiply-add the kernels give the bits of the CPU, and the two forces of a pair cancel exactly.
  target_compile_options(${target}_kernels PRIVATE
    $<$<COMPILE_LANGUAGE:CUDA>:-fmad=false --expt-relaxed-constexpr -Werror=all-warnings>)
  # This reduces the size to a fifth. Every driver that runs code of CUDA 13 can decompress it.
  if(CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
    target_compile_options(${target}_kernels PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:--compress-mode=size>)
  endif()
endfunction()
