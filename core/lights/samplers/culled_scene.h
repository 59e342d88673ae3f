#pragma once

#include <lightcull/light_sampler.h>

#include <memory>

#include "base/core_export.h"
#include "lights/groups/light_groups.h"
#include "lights/light/light_record.h"
#include "lights/ranges/range_tree.h"

namespace lightcull {

/// The tree and the groups from which `culled` chooses.
struct CulledScene {
    const Frame& frame;
    const LightGroups& groups;
    const RangeTree& tree;  ///< ranges over the groups
};

/// The sampler `culled`, for back ends that choose as it does.
class LIGHTCULL_CORE_EXPORT CulledSamplerBase : public LightSampler {
  public:
    /// The scene lives as long as the sampler. Passes change the ranges of the tree.
    virtual CulledScene scene() const noexcept = 0;
    /// The groups of scene(), for those that outlive it.
    virtual std::shared_ptr<const LightGroups> groups() const noexcept = 0;
};

}  // namespace lightcull
