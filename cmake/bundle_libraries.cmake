# Runs at install time. Gathers the shared libraries of `programs` in `folder`/lib and makes all of them look there only.
# In: programs (executables of the build tree), plug_ins (libraries that they open by name), folder, patchelf, strip.
if(NOT patchelf)
  message(FATAL_ERROR "patchelf was not found when the build was configured; install it and configure again")
endif()

# glibc belongs to the machine: it must fit the kernel and the machine's own loader.
set(glibc "^(ld-linux.*|libc|libm|libpthread|libdl|librt|libresolv|libutil|libanl|libnsl|libmvec|libnss_.*)\\.so")
file(GET_RUNTIME_DEPENDENCIES
     EXECUTABLES ${programs}
     LIBRARIES ${plug_ins}
     PRE_EXCLUDE_REGEXES ${glibc}
     RESOLVED_DEPENDENCIES_VAR libraries
     UNRESOLVED_DEPENDENCIES_VAR missing)
if(missing)
  message(FATAL_ERROR "libraries that the programs need were not found: ${missing}")
endif()

file(MAKE_DIRECTORY ${folder}/lib)
foreach(library ${libraries} ${plug_ins})
  # One file under the name that the loader asks for, instead of a file and links to it.
  get_filename_component(name ${library} NAME)
  file(REAL_PATH ${library} real)
  file(COPY_FILE ${real} ${folder}/lib/${name})
  file(CHMOD ${folder}/lib/${name} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  execute_process(COMMAND ${strip} --strip-unneeded ${folder}/lib/${name} COMMAND_ERROR_IS_FATAL ANY)
  # DT_RPATH, unlike DT_RUNPATH, also holds for libraries that are opened by name at run time.
  execute_process(COMMAND ${patchelf} --force-rpath --set-rpath $ORIGIN ${folder}/lib/${name}
                  COMMAND_ERROR_IS_FATAL ANY)
endforeach()
foreach(program ${programs})
  get_filename_component(name ${program} NAME)
  execute_process(COMMAND ${strip} ${folder}/bin/${name} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${patchelf} --force-rpath --set-rpath $ORIGIN/../lib ${folder}/bin/${name}
                  COMMAND_ERROR_IS_FATAL ANY)
endforeach()
list(LENGTH libraries count)
message(STATUS "${count} libraries are in ${folder}/lib")
