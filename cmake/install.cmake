# `cmake --install build/PRESET --prefix DIR` makes one folder that can be moved and copied:
#   bin/    tandem, mbd_server, dem_server, sph_server; tandem_step, which needs the machine's own OpenCASCADE;
#           dem_server_mpi, which needs the machine's own OpenMPI
#   lib/    libtandem_participant, and cmake/tandem for find_package(tandem) (participant/CMakeLists.txt)
#   lib/tandem/  every shared library that they need, except glibc: a machine with the same or a newer glibc runs them; also
#           the plug-ins of Cyclone DDS for DDS Security, which it opens by name (protocol/dds/certificates.cpp)
#   include/  headers of the participant kit
#   share/  tandem/{scenes, report.py, liquid_surface.py, schema.json, templates, fortran, README.md, docs and what else they link to}
# Programs find lib/ and share/ from where they are themselves (data_folder() in coordinator/report).
set(CMAKE_INSTALL_RPATH "$ORIGIN/../lib")
find_program(TANDEM_PATCHELF patchelf)

install(FILES ${PROJECT_SOURCE_DIR}/coordinator/report/report.py ${PROJECT_SOURCE_DIR}/coordinator/report/liquid_surface.py
              ${PROJECT_SOURCE_DIR}/common/scene/schema.json
        DESTINATION share/tandem)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/launch/scenes/ DESTINATION share/tandem/scenes)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/python/tandem ${PROJECT_SOURCE_DIR}/python/examples DESTINATION share/tandem/python
        FILES_MATCHING PATTERN "*.py" PATTERN "py.typed")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
              ${PROJECT_SOURCE_DIR}/CONTRIBUTING.md DESTINATION share/tandem)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION share/tandem/docs)

# Put after the programs' own install rules: they must lie in bin/ before they can be stripped.
function(tandem_install_libraries)
  install(CODE "
    set(programs \"$<TARGET_FILE:tandem>\" \"$<TARGET_FILE:mbd_server>\" \"$<TARGET_FILE:dem_server>\" \"$<TARGET_FILE:sph_server>\")
    set(plug_ins \"${TANDEM_DDS_PLUG_INS}\")
    set(own_libraries \"$<TARGET_FILE:tandem_participant>\")
    set(patchelf \"${TANDEM_PATCHELF}\")
    set(strip \"${CMAKE_STRIP}\")
    set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")
    include(\"${PROJECT_SOURCE_DIR}/cmake/bundle_libraries.cmake\")
  ")
endfunction()
cmake_language(DEFER CALL tandem_install_libraries)
install(PROGRAMS launch/start_mbd launch/start_dem launch/start_sph launch/start_server DESTINATION bin)
