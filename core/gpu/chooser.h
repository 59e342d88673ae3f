#pragma once

#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/baselines/paper_scene.h"
#include "lights/samplers/culled_scene.h"

namespace lightcull {

/// How a sampler chooses among what its sphere tree accepts: a shader, and what it reads besides.
struct Chooser {
    Span<const std::uint32_t> code;
    std::uint32_t workgroup;                 ///< invocations
    std::uint32_t shared_memory;             ///< bytes
    Span<const std::byte> leaves, lights;    ///< bindings 3 and 4; the scene's memory
    std::vector<std::uint32_t> constants{};  ///< after those of the walk (walk.glsl)
};

/// Groups, and the light BVH below them.
Chooser chooser_of(const CulledScene& scene);

/// Lights, and their numbers. The list is not empty.
Chooser chooser_of(const PaperScene& scene);

}  // namespace lightcull
