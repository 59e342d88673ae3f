#include "render/texture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lightcull {
namespace {

/// A texel column or row, and the weight of the one after it.
struct Tap {
    std::uint32_t first, second;
    float weight;
};

/// The tap for x in texels, any finite number.
Tap tap(float x, std::uint32_t size) noexcept {
    const float floor = std::floor(x);
    const auto n = static_cast<std::int64_t>(size);
    // Beyond 2^31 there is no fraction left, and which texel it is means nothing.
    const auto i = static_cast<std::int64_t>(std::clamp(floor, -0x1p31f, 0x1p31f)) % n;
    const auto first = static_cast<std::uint32_t>(i < 0 ? i + n : i);
    return {first, first + 1 == size ? 0 : first + 1, x - floor};
}

V2f to_texels(const Texture& t, const V2f& uv) noexcept {
    return {uv.x * static_cast<float>(t.width), (1.0f - uv.y) * static_cast<float>(t.height)};
}

V3f texel(const Texture& t, std::uint32_t x, std::uint32_t y) noexcept {
    return to_v3f(t.texels[std::size_t{y} * t.width + x]);
}

}  // namespace

V3f lookup(const Texture& texture, const V2f& uv) noexcept {
    const V2f p = to_texels(texture, uv);
    const Tap x = tap(p.x - 0.5f, texture.width);
    const Tap y = tap(p.y - 0.5f, texture.height);
    const V3f top = texel(texture, x.first, y.first) * (1.0f - x.weight) +
                    texel(texture, x.second, y.first) * x.weight;
    const V3f bottom = texel(texture, x.first, y.second) * (1.0f - x.weight) +
                       texel(texture, x.second, y.second) * x.weight;
    return top * (1.0f - y.weight) + bottom * y.weight;
}

}  // namespace lightcull
