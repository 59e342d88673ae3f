#pragma once

#include <lightcull/float3.h>
#include <lightcull/light_sampler.h>
#include <lightcull/render/renderer.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace lightcull::python {

/// What a sampler has learned, as the pixels of an image see it, row 0 at the top.
struct LearnedView {
    std::uint32_t width, height;
    std::vector<std::int32_t> cells;  ///< the cell that the pixel's point lies in; -1: none
    std::vector<float> visibility;    ///< SamplerInfo::learned_visibility() of `light`
    std::vector<float3> normals;      ///< towards the camera, unit length; 0 where nothing is seen
    std::uint32_t light;
    std::optional<float3> light_position;  ///< metres; none: infinitely far
    std::size_t cell_count;                ///< cells there are, seen or not
    std::size_t memory_size;               ///< bytes that they take
};

/// `light` is the one whose visibility differs most from pixel to pixel, of some hundreds that the
/// sampler chooses for the image. None where nothing was learned, or none of that is seen.
std::optional<LearnedView> learned_view(const LightSampler& sampler, const Scene& scene,
                                        const RenderSettings& settings);

}  // namespace lightcull::python
