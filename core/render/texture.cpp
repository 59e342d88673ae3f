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

/// The extent of the texels that lookups between `low` and `high` (texels) can touch: the first,
/// and how many.
struct Extent {
    std::uint32_t first, count;
};
Extent touched(float low, float high, std::uint32_t size) noexcept {
    const Tap start = tap(low - 0.5f, size);
    const float count = std::floor(high - 0.5f) - std::floor(low - 0.5f) + 2.0f;
    const auto n = static_cast<float>(size);
    return {start.first, count < n ? static_cast<std::uint32_t>(count) : size};
}

float mean_of_touched_texels(const Texture& t, const V2f& low, const V2f& high) noexcept {
    const Extent columns = touched(low.x, high.x, t.width);
    const Extent rows = touched(low.y, high.y, t.height);
    double sum = 0.0;
    for (std::uint32_t j = 0; j < rows.count; ++j) {
        for (std::uint32_t i = 0; i < columns.count; ++i) {
            sum += static_cast<double>(
                luminance(texel(t, (columns.first + i) % t.width, (rows.first + j) % t.height)));
        }
    }
    return static_cast<float>(sum / (static_cast<double>(rows.count) * columns.count));
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

float mean_luminance(const Texture& texture, const V2f& a, const V2f& b, const V2f& c) {
    const V2f pa = to_texels(texture, a), pb = to_texels(texture, b), pc = to_texels(texture, c);
    const V2f low(std::min({pa.x, pb.x, pc.x}), std::min({pa.y, pb.y, pc.y}));
    const V2f high(std::max({pa.x, pb.x, pc.x}), std::max({pa.y, pb.y, pc.y}));

    // The places are the centroids of n * n equal triangles, about two to a texel, or a coarse grid
    // over a footprint of many texels.
    constexpr float kMostPerEdge = 128.0f;
    const float extent = std::max(high.x - low.x, high.y - low.y);
    const auto n = static_cast<int>(std::clamp(std::ceil(2.0f * extent), 2.0f, kMostPerEdge));
    const float step = 1.0f / static_cast<float>(n);
    double sum = 0.0;
    const auto add = [&](int i, int j, float third) {
        const float u = (static_cast<float>(i) + third) * step;
        const float v = (static_cast<float>(j) + third) * step;
        sum += static_cast<double>(luminance(lookup(texture, a + (b - a) * u + (c - a) * v)));
    };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; i + j < n; ++j) {
            add(i, j, 1.0f / 3.0f);
            // Between these triangles lie others, upside down.
            if (i + j + 1 < n) add(i, j, 2.0f / 3.0f);
        }
    }
    const auto mean = static_cast<float>(sum / (static_cast<double>(n) * n));
    return mean > 0.0f ? mean : mean_of_touched_texels(texture, low, high);
}

}  // namespace lightcull
