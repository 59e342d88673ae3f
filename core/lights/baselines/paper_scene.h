#pragma once

#include <lightcull/samplers.h>

#include <cstdint>

#include "base/core_export.h"
#include "lights/baselines/culling_tree.h"

namespace lightcull {

/// The tree that `paper` chooses from, and the way in which it chooses (PaperOptions).
struct PaperScene {
    const CullingTree& tree;
    bool range_at_vertex, weight_by_g;
    std::uint32_t list_size;

    static constexpr std::uint32_t kMaxListSize = 64;
};

/// The sampler `paper`, for back ends that choose as it does.
class LIGHTCULL_CORE_EXPORT PaperSamplerBase : public LightSampler, public VertexCulling {
  public:
    /// The scene lives as long as the sampler. Passes change the ranges of the tree.
    virtual PaperScene scene() const noexcept = 0;
};

}  // namespace lightcull
