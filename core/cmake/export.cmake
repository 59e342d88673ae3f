# What find_package(lightcull) and pkg-config read, for an install tree and for this build tree.

include(CMakePackageConfigHelpers)

set(LIGHTCULL_COMPONENTS base lights)
if(LIGHTCULL_RENDER)
  list(APPEND LIGHTCULL_COMPONENTS image render virtual_lights)
  get_directory_property(embree_VERSION_MAJOR DIRECTORY render DEFINITION embree_VERSION_MAJOR)
endif()
if(TARGET lightcull_gpu)
  list(APPEND LIGHTCULL_COMPONENTS gpu)
endif()
list(TRANSFORM LIGHTCULL_COMPONENTS PREPEND lightcull_ OUTPUT_VARIABLE targets)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/lightcull)
set(LIGHTCULL_STATIC TRUE)
if(BUILD_SHARED_LIBS)
  set(LIGHTCULL_STATIC FALSE)
endif()

configure_package_config_file(cmake/lightcullConfig.cmake.in
  ${PROJECT_BINARY_DIR}/lightcullConfig.cmake
  INSTALL_DESTINATION ${package_dir}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lightcullConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
# Before 3.26 CMake cannot leave out a target that a static library was built with. Its flags reach
# nobody: what is private to a static library is exported for linking only.
export(TARGETS ${targets} lightcull_options NAMESPACE lightcull::
  FILE ${PROJECT_BINARY_DIR}/lightcullTargets.cmake)

if(NOT LIGHTCULL_INSTALL)
  return()
endif()

install(TARGETS ${targets} EXPORT lightcullTargets)
install(EXPORT lightcullTargets NAMESPACE lightcull:: DESTINATION ${package_dir})
install(FILES
  ${PROJECT_BINARY_DIR}/lightcullConfig.cmake
  ${PROJECT_BINARY_DIR}/lightcullConfigVersion.cmake
  DESTINATION ${package_dir})

# The headers of a component but lights are in a folder of its name.
file(GLOB headers CONFIGURE_DEPENDS include/lightcull/*.h)
install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lightcull)
foreach(component IN LISTS LIGHTCULL_COMPONENTS)
  if(IS_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/include/lightcull/${component})
    install(DIRECTORY include/lightcull/${component}
      DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lightcull)
  endif()
endforeach()

# For lights alone, which is what hosts link that are not built by CMake. A static library needs
# what it was built with, and the C++ library where the host is linked as C.
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH PKGCONFIG_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
set(PKGCONFIG_REQUIRES "")
set(PKGCONFIG_LIBS_PRIVATE "")
if(LIGHTCULL_STATIC)
  set(PKGCONFIG_REQUIRES "libhwy, tbb")
  set(PKGCONFIG_LIBS_PRIVATE ${CMAKE_CXX_IMPLICIT_LINK_LIBRARIES})
  list(FILTER PKGCONFIG_LIBS_PRIVATE INCLUDE REGEX "^(stdc\\+\\+|c\\+\\+|c\\+\\+abi|m)$")
  list(TRANSFORM PKGCONFIG_LIBS_PRIVATE PREPEND -l)
  list(JOIN PKGCONFIG_LIBS_PRIVATE " " PKGCONFIG_LIBS_PRIVATE)
endif()
configure_file(cmake/lightcull-lights.pc.in ${PROJECT_BINARY_DIR}/lightcull-lights.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/lightcull-lights.pc DESTINATION ${pkgconfig_dir})
