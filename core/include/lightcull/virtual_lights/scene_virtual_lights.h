#pragma once

#include <lightcull/export.h>
#include <lightcull/render/scene.h>

#include <cstdint>

namespace lightcull {

/// Adds virtual lights to a scene as lights that samplers choose from: where `light_paths` paths
/// from the emitters and the environment meet surfaces, up to `bounces` times (1 to 3), of what was
/// added so far. A path tracer then has, with a max_depth of 2, direct light and what bounces. Near
/// a virtual light its light is bounded, as VirtualLightRenderer says. Equal seeds give equal
/// lights. The call runs in the caller's TBB arena.
///
/// Throws Error for numbers that make no sense, for a scene that is committed or has virtual lights
/// already, and if a material is a perfect mirror. Without any light it adds none.
LIGHTCULL_EXPORT void add_virtual_lights(Scene& scene, std::uint32_t light_paths,
                                         std::uint32_t bounces, std::uint64_t seed = 0);

}  // namespace lightcull
