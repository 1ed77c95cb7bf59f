# Headers that most sources include are parsed once per build (TANDEM_PRECOMPILE), one set for the product and one for the tests.
# Sources include what they use all the same: the presets release and cuda are built without.
set(TANDEM_PRODUCT_HEADERS <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory> <optional> <span>
    <string> <vector> <fmt/format.h> <nlohmann/json.hpp>)
set(TANDEM_TEST_HEADERS ${TANDEM_PRODUCT_HEADERS} <random> <gmock/gmock.h> <gtest/gtest.h>)

# A precompiled header serves only code of the same kind; libraries need -fPIC.
if(TANDEM_PRECOMPILE)
  set(CMAKE_CXX_COMPILE_OPTIONS_PIE ${CMAKE_CXX_COMPILE_OPTIONS_PIC})
endif()

# tandem_precompiled(NAME HEADERS... LIBS ...): a target that holds a set.
function(tandem_precompiled name)
  cmake_parse_arguments(ARG "" "" "HEADERS;LIBS" ${ARGN})
  if(TANDEM_PRECOMPILE)
    file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/${name}.cpp CONTENT "// Holds the precompiled headers.\n")
    add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/generated/${name}.cpp)
    tandem_target(${name} NO_PRECOMPILE)
    target_link_libraries(${name} PRIVATE ${ARG_LIBS})
    target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
  endif()
endfunction()
