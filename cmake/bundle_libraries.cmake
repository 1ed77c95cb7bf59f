# Runs at install time. Gathers the shared libraries of `programs` and `own_libraries` in `folder`/lib/tandem and makes
# all of them look there only.
# In: programs (executables of the build tree), plug_ins (libraries that they open by name), own_libraries (libraries of the
# build tree that are in `folder`/lib already, with links to their versions), folder, patchelf, strip.
if(NOT patchelf)
  message(FATAL_ERROR "patchelf was not found when the build was configured; install it and configure again")
endif()

# glibc belongs to the machine: it must fit the kernel and the machine's own loader.
set(glibc "^(ld-linux.*|libc|libm|libpthread|libdl|librt|libresolv|libutil|libanl|libnsl|libmvec|libnss_.*)\\.so")
file(GET_RUNTIME_DEPENDENCIES
     EXECUTABLES ${programs}
     LIBRARIES ${plug_ins} ${own_libraries}
     PRE_EXCLUDE_REGEXES ${glibc}
     RESOLVED_DEPENDENCIES_VAR libraries
     UNRESOLVED_DEPENDENCIES_VAR missing)
if(missing)
  message(FATAL_ERROR "libraries that the programs need were not found: ${missing}")
endif()

# A solver that is linked with libtandem_participant searches lib/ too, and may need other versions of the same libraries, such as
# the C++ run-time library of a newer compiler. Those of the folder are therefore where only the folder's files search.
set(bundle ${folder}/lib/tandem)
file(MAKE_DIRECTORY ${bundle})

# Strips a file and makes it search `path` only. DT_RPATH, unlike DT_RUNPATH, also holds for libraries that are opened by name at
# run time.
function(finish file path)
  execute_process(COMMAND ${strip} --strip-unneeded ${file} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${patchelf} --force-rpath --set-rpath ${path} ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(library ${libraries} ${plug_ins})
  # One file under the name that the loader asks for, instead of a file and links to it.
  get_filename_component(name ${library} NAME)
  file(REAL_PATH ${library} real)
  file(COPY_FILE ${real} ${bundle}/${name})
  file(CHMOD ${bundle}/${name} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  finish(${bundle}/${name} $ORIGIN)
endforeach()
foreach(library ${own_libraries})
  get_filename_component(name ${library} NAME)
  finish(${folder}/lib/${name} $ORIGIN/tandem)
endforeach()
foreach(program ${programs})
  get_filename_component(name ${program} NAME)
  finish(${folder}/bin/${name} $ORIGIN/../lib/tandem)
endforeach()
list(LENGTH libraries count)
message(STATUS "${count} libraries are in ${bundle}")
