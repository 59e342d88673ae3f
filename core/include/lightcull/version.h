#pragma once

#include <lightcull/export.h>

/// The version of these headers. CMake and pkg-config take theirs from here. Until 1.0 another
/// minor version may break hosts, in source and in binary form; a patch breaks neither.
#define LIGHTCULL_VERSION_MAJOR 0
#define LIGHTCULL_VERSION_MINOR 2
#define LIGHTCULL_VERSION_PATCH 0
#define LIGHTCULL_VERSION_STRING "0.2.0"

#ifdef __cplusplus
namespace lightcull {

/// The version of the library that is linked, which is LIGHTCULL_VERSION_STRING of the headers that
/// it was built with.
LIGHTCULL_EXPORT const char* version() noexcept;

}  // namespace lightcull
#endif
