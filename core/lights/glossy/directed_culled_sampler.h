#pragma once

#include <lightcull/samplers.h>

#include <memory>

#include "base/core_export.h"
#include "lights/light/light_record.h"

namespace lightcull {

/// The base of what make_directed_culled_sampler() makes, to be told from other samplers.
class LIGHTCULL_CORE_EXPORT DirectedCulledSamplerBase : public LightSampler {};

/// Makes `culled` for lights of which some are glossy points: each has a range of its own, which
/// depends on the direction. reach, set_count: the arguments of RandomRanges.
std::unique_ptr<LightSampler> make_directed_culled_sampler(const LightTable& table, float reach,
                                                           std::uint32_t set_count);

}  // namespace lightcull
