#pragma once

#include <lightcull/render/scene.h>

#include <cstdint>
#include <memory>

namespace lightcull::bench {

/// A walled court of 40 x 40 m full of pillars and lanterns, seen from a corner. A lantern is an
/// icosahedron of 20 lights; powers are log-normal, and their sum is the same for any number.
/// light_count: a multiple of 20.
std::shared_ptr<const Scene> make_courtyard(std::uint32_t light_count);

}  // namespace lightcull::bench
