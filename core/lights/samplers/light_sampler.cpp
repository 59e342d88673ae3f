#include <lightcull/error.h>
#include <lightcull/light_sampler.h>
#include <lightcull/sampler_info.h>
#include <lightcull/samplers.h>

#include "base/parallel_blocks.h"

namespace lightcull {

void LightSelector::select(Span<const ShadingPoint> points, Span<const float> u,
                           Span<Selection> selections) const {
    constexpr std::size_t kBlock = 256;
    for_each_block(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) selections[i] = select(points[i], u[i]);
    });
}

void LightSelector::report(Span<const LightOutcome>) const noexcept {
}

LightUpdate LightSampler::update(Span<const Light>, float) {
    throw Error("update: this sampler takes no changed lights");
}

void LightSampler::restore_learned(Span<const std::uint8_t>) {
    throw Error("restore_learned: this sampler does not learn");
}

const SamplerInfo* sampler_info(const LightSelector& sampler) noexcept {
    return dynamic_cast<const SamplerInfo*>(&sampler);
}

const VertexCulling* vertex_culling(const LightSelector& sampler) noexcept {
    return dynamic_cast<const VertexCulling*>(&sampler);
}

}  // namespace lightcull
