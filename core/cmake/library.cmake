# A library of ours: the target lightcull_<component>, lightcull::<component> to hosts. Static or
# shared as BUILD_SHARED_LIBS says.
function(lightcull_library component)
  set(target lightcull_${component})
  add_library(${target} ${ARGN})
  add_library(lightcull::${component} ALIAS ${target})
  # Until 1.0 a minor version may change what hosts were compiled with.
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${component}
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON
    INSTALL_RPATH $ORIGIN)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/core)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:lightcull_options>)
  if(NOT BUILD_SHARED_LIBS)
    target_compile_definitions(${target} PRIVATE LIGHTCULL_STATIC)
  endif()
endfunction()

# Stops unless the package that was just looked for is there, and names what needs it.
macro(lightcull_need component package debian)
  if(NOT ${package}_FOUND)
    message(FATAL_ERROR
      "lightcull::${component} needs ${package}, which was not found (Debian: ${debian})")
  endif()
endmacro()
