#pragma once

#include <cstdint>

#include "scene.h"

namespace host {

/// Prints a table of errors: of each order of work, and of some that a host should not choose,
/// up to that many samples of each pixel.
void compare(const Scene& scene, std::uint32_t max_samples);

}  // namespace host
