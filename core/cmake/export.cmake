# What find_package(lightcull) reads, for an install tree and for this build tree.

include(CMakePackageConfigHelpers)

set(LIGHTCULL_COMPONENTS base lights)
install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h"
  PATTERN gpu EXCLUDE
  PATTERN image EXCLUDE
  PATTERN render EXCLUDE
  PATTERN virtual_lights EXCLUDE)
if(LIGHTCULL_RENDER)
  list(APPEND LIGHTCULL_COMPONENTS image render virtual_lights)
  get_directory_property(embree_VERSION_MAJOR DIRECTORY render DEFINITION embree_VERSION_MAJOR)
  install(DIRECTORY include/lightcull/image include/lightcull/render include/lightcull/virtual_lights
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lightcull)
endif()

if(TARGET lightcull_gpu)
  list(APPEND LIGHTCULL_COMPONENTS gpu)
  install(DIRECTORY include/lightcull/gpu DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lightcull)
endif()

list(TRANSFORM LIGHTCULL_COMPONENTS PREPEND lightcull_ OUTPUT_VARIABLE targets)
install(TARGETS ${targets} EXPORT lightcullTargets)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/lightcull)
install(EXPORT lightcullTargets NAMESPACE lightcull:: DESTINATION ${package_dir})
# Before 3.26 CMake cannot leave out a target that a static library was built with. Its flags reach
# nobody: what is private to a static library is exported for linking only.
export(TARGETS ${targets} lightcull_options NAMESPACE lightcull::
  FILE ${PROJECT_BINARY_DIR}/lightcullTargets.cmake)

configure_package_config_file(cmake/lightcullConfig.cmake.in
  ${PROJECT_BINARY_DIR}/lightcullConfig.cmake
  INSTALL_DESTINATION ${package_dir}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lightcullConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/lightcullConfig.cmake
  ${PROJECT_BINARY_DIR}/lightcullConfigVersion.cmake
  DESTINATION ${package_dir})
