# The target portable_image: core/image, compiled against the OpenImageIO in the folder
# LIGHTCULL_OPENIMAGEIO in place of the system's. core/tools/wheels.sh lays that folder: `lib` from the
# wheel of OpenImageIO, `include` from its sources of the same version, which is in the file `version`.

file(STRINGS ${LIGHTCULL_OPENIMAGEIO}/version version)
string(REPLACE "." ";" parts ${version})
list(GET parts 0 PROJECT_VERSION_MAJOR)
list(GET parts 1 PROJECT_VERSION_MINOR)
list(GET parts 2 PROJECT_VERSION_PATCH)
list(GET parts 3 PROJECT_VERSION_TWEAK)

# OpenImageIO's own configuration does what follows, and looks for much that is not needed here.
set(PROJ_NAMESPACE OpenImageIO)
set(PROJ_VERSION_NAMESPACE v${PROJECT_VERSION_MAJOR}_${PROJECT_VERSION_MINOR})
set(OIIO_USE_COMPILED_FMT_VALUE 0)
set(Imath_VERSION_MAJOR 3)
set(Imath_VERSION_MINOR 1)
set(generated ${CMAKE_CURRENT_BINARY_DIR}/openimageio)
configure_file(${LIGHTCULL_OPENIMAGEIO}/include/OpenImageIO/oiioversion.h.in
  ${generated}/OpenImageIO/oiioversion.h @ONLY)
find_package(fmt REQUIRED)  # libfmt-dev
foreach(name IN ITEMS format ostream printf std)
  file(CONFIGURE OUTPUT ${generated}/OpenImageIO/detail/fmt/${name}.h
    CONTENT "#include <fmt/${name}.h>\n")
endforeach()

file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/../core/image/*.cpp)
add_library(portable_image STATIC ${sources})
set_target_properties(portable_image PROPERTIES
  POSITION_INDEPENDENT_CODE ON
  CXX_VISIBILITY_PRESET hidden
  VISIBILITY_INLINES_HIDDEN ON)
target_compile_definitions(portable_image PRIVATE LIGHTCULL_STATIC)
target_include_directories(portable_image SYSTEM PRIVATE
  ${generated} ${LIGHTCULL_OPENIMAGEIO}/include)
target_link_libraries(portable_image PRIVATE
  lightcull::base fmt::fmt-header-only PkgConfig::OpenColorIO
  ${LIGHTCULL_OPENIMAGEIO}/lib/libOpenImageIO.so
  ${LIGHTCULL_OPENIMAGEIO}/lib/libOpenImageIO_Util.so)
