#pragma once

#include <lightcull/light.h>
#include <lightcull/lightcull.h>

#include <cstddef>
#include <vector>

namespace lightcull {

/// Throws Error with a message that names the light whose size is wrong.
std::vector<Light> to_cpp(const lightcull_light* lights, std::size_t count);

}  // namespace lightcull
