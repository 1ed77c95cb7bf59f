# Switches of the build. AUTO means: used where it is found, and the configure log says which it was.
set(TANDEM_CUDA AUTO CACHE STRING "CUDA back end of dem_server: AUTO, ON or OFF")
set(TANDEM_DDS AUTO CACHE STRING "Cyclone DDS channel: AUTO, ON or OFF")
set(TANDEM_MPI AUTO CACHE STRING "Several ranks of dem_server, by MPI: AUTO, ON or OFF")
set(TANDEM_STEP AUTO CACHE STRING "Reader of STEP files, by OpenCASCADE: AUTO, ON or OFF")
set(TANDEM_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")
option(TANDEM_ASSERTIONS "Keep assert() in optimised builds" OFF)
option(TANDEM_TESTS "Build the tests" ON)
option(TANDEM_PRECOMPILE "Precompile the headers that most sources include" OFF)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
if(TANDEM_ASSERTIONS)
  string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_RELWITHDEBINFO "${CMAKE_CXX_FLAGS_RELWITHDEBINFO}")
  string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")
endif()
# Line tables are enough for stack traces and keep the objects small.
string(REPLACE "-g" "-g1" CMAKE_CXX_FLAGS_RELWITHDEBINFO "${CMAKE_CXX_FLAGS_RELWITHDEBINFO}")

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

find_program(CCACHE ccache)
if(CCACHE)
  # ccache looks into precompiled headers, and takes an object for any clone of the same sources.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
                                  CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CCACHE})
endif()
