#include <lightcull/light_sampler.h>

#include <algorithm>

#include "base/parallel_blocks.h"
#include "lights/ranges/pattern.h"

namespace lightcull {

void LightSampler::select(Span<const ShadingPoint> points, Span<const float> u,
                          Span<Selection> selections) const noexcept {
    constexpr std::size_t kBlock = 256;
    for_each_block(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) selections[i] = select(points[i], u[i]);
    });
}

float LightSampler::vertex_prob(const ShadingPoint&, const Receipt&, std::uint32_t,
                                const float3&) const noexcept {
    return 1.0f;
}

std::uint32_t set_of_pixel(std::uint32_t x, std::uint32_t y, std::uint32_t set_count) noexcept {
    const std::uint32_t log4_sets = log4_of(set_count);
    const std::uint32_t mask = (1u << log4_sets) - 1u;
    return ((y & mask) << log4_sets) | (x & mask);
}

std::uint32_t set_of_packet(std::uint32_t packet, std::uint32_t set_count) noexcept {
    // Few sets, so that a pass touches little memory, but spread over all rotations.
    constexpr std::uint32_t kSetsOfBounces = 16;
    const std::uint32_t used = std::min(set_count, kSetsOfBounces);
    const std::uint32_t log4_used = log4_of(used);
    const std::uint32_t rank_among_used = rank_of_set(packet % used, log4_used);
    return set_of_rank(rank_among_used * (set_count / used), log4_of(set_count));
}

}  // namespace lightcull
