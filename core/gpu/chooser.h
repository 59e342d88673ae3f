#pragma once

#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/baselines/paper_scene.h"
#include "lights/samplers/culled_scene.h"

namespace lightcull {

/// The way in which a sampler chooses among what its sphere tree accepts: a shader, and the data
/// that it reads besides.
struct Chooser {
    Span<const std::uint32_t> code;
    std::uint32_t workgroup;                 ///< invocations in a workgroup
    std::uint32_t shared_memory;             ///< shared memory of a workgroup, bytes
    Span<const std::byte> leaves, lights;    ///< bindings 3 and 4; they lie in the scene's memory
    std::vector<std::uint32_t> constants{};  ///< specialization constants after those of the walk
                                             ///< (walk.glsl)
};

/// The chooser of groups, and the light BVH below them.
Chooser chooser_of(const CulledScene& scene);

/// The chooser of lights, and their numbers. The list is not empty.
Chooser chooser_of(const PaperScene& scene);

}  // namespace lightcull
