# SPDX-License-Identifier: MIT
#
# What a program that links the static library needs besides it, as arguments of a C linker: LAPACK, BLAS and zlib as they were
# found, OpenMP and the run-time library of Fortran. Sets
#   link_names   a list, for CMake
#   pc_private   the same for gyroakf.pc, where they stand for the static library ...
#   pc_public    ... and where for the one that is installed: of a static one everybody needs them
#   pc_dir       from the folder of gyroakf.pc to the prefix

function(add_link_name list library) # appends a library of find_package: a flag, a file, a framework
  cmake_path(GET library PARENT_PATH dir)
  if(library MATCHES "\\.framework$")
    string(REGEX REPLACE ".*/(.*)\\.framework$" "\\1" name "${library}")
    set(found "-framework ${name}")
  elseif(library MATCHES "/lib([^/]*)\\.(so|dylib|tbd|a)[.0-9]*$")
    set(name "${CMAKE_MATCH_1}")
    set(found "-l${name}")
    if(library MATCHES "\\.a$" AND EXISTS "${dir}/lib${name}${CMAKE_SHARED_LIBRARY_SUFFIX}")
      set(found "${library}") # -l would pass over it for the shared library beside it
    elseif(NOT dir IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES)
      set(found "-L${dir};${found}")
    endif()
  else() # a flag
    set(found "${library}")
  endif()
  set(${list} ${${list}} ${found} PARENT_SCOPE)
endfunction()

set(link_names "")
foreach(library IN LISTS LAPACK_LINKER_FLAGS LAPACK_LIBRARIES BLAS_LIBRARIES ZLIB_LIBRARIES)
  if(NOT TARGET "${library}")
    add_link_name(link_names "${library}")
  endif()
endforeach()
if(GYROAKF_OPENMP)
  foreach(library IN LISTS OpenMP_Fortran_LIBRARIES)
    add_link_name(link_names "${library}")
  endforeach()
endif()
# the run-time library of Fortran, and where it is, as far as the C compiler does not know it
foreach(dir IN LISTS CMAKE_Fortran_IMPLICIT_LINK_DIRECTORIES)
  if(NOT dir IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES)
    list(APPEND link_names "-L${dir}")
  endif()
endforeach()
foreach(name IN LISTS CMAKE_Fortran_IMPLICIT_LINK_LIBRARIES)
  if(NOT name IN_LIST CMAKE_C_IMPLICIT_LINK_LIBRARIES)
    list(APPEND link_names "-l${name}")
  endif()
endforeach()
list(REMOVE_DUPLICATES link_names)

string(REPLACE ";" " " pc_private "${link_names}")
set(pc_public "")
if(NOT BUILD_SHARED_LIBS)
  set(pc_public " ${pc_private}")
  set(pc_private "")
endif()
cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" OUTPUT_VARIABLE pc_dir)
