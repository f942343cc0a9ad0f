# find_package(gearmath) gives gearmath::gearmath, the shared library where there is one, and gearmath::static.
get_filename_component(_gearmath_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

function(_gearmath_target name)
  find_library(_gearmath_${name} NAMES ${ARGN} PATHS "${_gearmath_prefix}/lib" NO_DEFAULT_PATH NO_CACHE)
  if(_gearmath_${name} AND NOT TARGET gearmath::${name})
    add_library(gearmath::${name} UNKNOWN IMPORTED)
    set_target_properties(gearmath::${name} PROPERTIES
      IMPORTED_LOCATION "${_gearmath_${name}}"
      INTERFACE_INCLUDE_DIRECTORIES "${_gearmath_prefix}/include/gearmath")
    if(UNIX)
      set_target_properties(gearmath::${name} PROPERTIES INTERFACE_LINK_LIBRARIES m)
    endif()
  endif()
endfunction()

_gearmath_target(gearmath libgearmath.so libgearmath.dylib libgearmath.dll.a libgearmath.a gearmath)
_gearmath_target(static libgearmath.a)
if(NOT TARGET gearmath::gearmath)
  set(gearmath_FOUND FALSE)
  set(gearmath_NOT_FOUND_MESSAGE "no libgearmath in ${_gearmath_prefix}/lib")
endif()
unset(_gearmath_prefix)
