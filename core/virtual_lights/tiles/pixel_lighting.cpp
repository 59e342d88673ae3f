#include "virtual_lights/tiles/pixel_lighting.h"

#include "base/random.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lightcull {

std::uint32_t PassLights::subset_of(std::uint32_t x, std::uint32_t y) const noexcept {
    const std::uint32_t subsets = lights.subsets(), step = pass.options.interleave;
    const auto turn = static_cast<std::uint32_t>(hash(pass.key, 0x7375627365740) % subsets);
    return ((y % step) * step + x % step + turn) % subsets;
}

void PixelLighting::add_all(std::size_t pixel, const PreparedLights::List& list) {
    constexpr std::size_t kTogether = 64;
    const V3f at = of_pass_.pass.view.surfaces[pixel].position;
    std::array<float, kTogether> distances2;
    std::array<std::uint32_t, kTogether> near;  // 0 or 1
    for (std::size_t begin = 0; begin < list.size(); begin += kTogether) {
        const std::size_t count = std::min(list.size() - begin, kTogether);
        const float *x = list.x.data() + begin, *y = list.y.data() + begin,
                    *z = list.z.data() + begin, *farthest2 = list.farthest2.data() + begin;
        // The loop has no branches, so that the compiler makes vectors of it.
        for (std::size_t i = 0; i < count; ++i) {
            const float dx = x[i] - at.x, dy = y[i] - at.y, dz = z[i] - at.z;
            const float distance2 = dx * dx + dy * dy + dz * dz;
            distances2[i] = distance2;
            near[i] = static_cast<std::uint32_t>(distance2 > 0.0f) &
                      static_cast<std::uint32_t>(distance2 <= farthest2[i]);
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (near[i] == 0) continue;
            add_near(pixel, list.index[begin + i], V3f(x[i], y[i], z[i]) - at, distances2[i]);
        }
    }
}

void PixelLighting::add_near(std::size_t pixel, std::uint32_t index, const V3f& way,
                             float distance2) {
    const LightingPass& pass = of_pass_.pass;
    const VirtualLight& light = of_pass_.lights.light(index);
    const Surface& surface = pass.view.surfaces[pixel];
    const float distance = std::sqrt(distance2);
    const V3f direction = way / distance;
    const V3f sent = intensity(light, -direction);
    const float strength = luminance(sent);
    if (!(strength > 0.0f)) return;
    const float weight =
        of_pass_.acceptance.weight(of_pass_.lights.of_light(index), strength, distance);
    if (!(weight > 0.0f)) return;
    ++counts_.accepted;
    if (!pass.of_pixels.empty()) ++pass.of_pixels[pixel].accepted;
    if (surface.normal.dot(direction) <= 0.0f) return;
    const V3f value = surface.bsdf.evaluate(direction).value * sent *
                      (scale_ * weight / std::max(distance2, of_pass_.nearest2));
    if (value == V3f(0.0f)) return;
    if (pass.options.shadows == VirtualShadows::kRays) {
        rays_.push_back(segment(surface.origin, light.position));
        values_.push_back(value);
        return;
    }
    const ImperfectShadowMaps* maps = of_pass_.maps;
    const bool is_dark = maps != nullptr && maps->occluded(index, light, surface.position);
    if (!is_dark) pixels_[pixel] += value;
}

void PixelLighting::finish(std::size_t pixel) {
    if (rays_.empty()) return;
    occluded_.resize(rays_.size());
    of_pass_.pass.tracer.occluded(rays_, occluded_);
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        if (occluded_[i] == 0) pixels_[pixel] += values_[i];
    }
    counts_.shadow_rays += rays_.size();
    rays_.clear();
    values_.clear();
}

void PixelLighting::count(std::size_t pixel, std::size_t listed) {
    counts_.listed += listed;
    const Span<LightsOfPixel> of_pixels = of_pass_.pass.of_pixels;
    if (!of_pixels.empty()) of_pixels[pixel].listed += static_cast<std::uint32_t>(listed);
}

}  // namespace lightcull
