# Sets TANDEM_HAS_DDS.
set(TANDEM_HAS_DDS OFF)
if(NOT TANDEM_DDS STREQUAL "OFF")
  find_package(CycloneDDS QUIET)
  if(CycloneDDS_FOUND)
    set(TANDEM_HAS_DDS ON)
  elseif(TANDEM_DDS STREQUAL "ON")
    message(FATAL_ERROR "TANDEM_DDS=ON, but Cyclone DDS was not found; "
                        "install cyclonedds-dev and cyclonedds-tools or configure with TANDEM_DDS=OFF")
  endif()
endif()
message(STATUS "tandem: Cyclone DDS channel ${TANDEM_HAS_DDS}")
