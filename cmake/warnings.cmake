# tandem_target(TARGET [NO_PRECOMPILE]): what every target of ours gets.
function(tandem_target target)
  cmake_parse_arguments(ARG "NO_PRECOMPILE" "" "" ${ARGN})
  if(TANDEM_PRECOMPILE AND NOT ARG_NO_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM ${TANDEM_PRECOMPILED})
  endif()
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

# Also checks the alignment of every access, in builds with the undefined-behaviour sanitizer.
function(tandem_check_alignment target)
  if(TANDEM_SANITIZE MATCHES undefined)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=alignment>)
  endif()
endfunction()

# tandem_computes(TARGET): most of the time of a run is spent in TARGET. The preset dev optimises the rest less, to be built sooner.
function(tandem_computes target)
  if(CMAKE_BUILD_TYPE STREQUAL "RelWithDebInfo" AND NOT TANDEM_SANITIZE)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-O2>)
    # GCC 12 crashes where a precompiled header was made at another level.
    set_target_properties(${target} PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)
  endif()
endfunction()
