# tandem_target(TARGET): what every target of ours gets.
function(tandem_target target)
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/generated)
  # -Wrestrict: GCC 12 raises it falsely on std::string concatenation (GCC bug 105651).
  set(flags -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wno-restrict -Werror
            # Results are the same bits on every machine and back end only without fused multiply-add.
            -ffp-contract=off)
  if(TANDEM_SANITIZE)
    # -Wmaybe-uninitialized: GCC 12 raises it falsely inside std::regex when sanitizers instrument it (GCC bug 105562).
    list(APPEND flags -Wno-maybe-uninitialized -fsanitize=${TANDEM_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    # These checks of each pointer double the time to compile. The address sanitizer stops at most of what `null` and
    # `object-size` would tell; casts to a wrong class are not looked for; alignment is at stake where bytes become messages,
    # so the protocol's targets check it (tandem_check_alignment).
    if(TANDEM_SANITIZE MATCHES address)
      list(APPEND flags -fno-sanitize=null,object-size,vptr,alignment)
    endif()
    target_link_options(${target} PUBLIC -fsanitize=${TANDEM_SANITIZE})
    target_compile_definitions(${target} PRIVATE TANDEM_SANITIZED)
  endif()
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:${flags}>)
endfunction()

# For targets with kernels that must give the bits of the CPU.
function(tandem_kernels target)
  # Without fused multiply-add the two forces of a pair cancel exactly as well.
  target_compile_options(${target} PRIVATE
    $<$<COMPILE_LANGUAGE:CUDA>:-fmad=false --expt-relaxed-constexpr -Werror=all-warnings>)
  # This reduces the size to a fifth. Every driver that runs code of CUDA 13 can decompress it.
  if(CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:--compress-mode=size>)
  endif()
endfunction()

# Also checks the alignment of every access, in builds with the undefined-behaviour sanitizer.
function(tandem_check_alignment target)
  if(TANDEM_SANITIZE MATCHES undefined)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=alignment>)
  endif()
endfunction()
