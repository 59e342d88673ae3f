#include "render/texture.h"

#include "base/memory_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

/// The numbers that all encoded values of a type stand for.
template <typename T>
using Decoded = std::array<float, std::size_t{std::numeric_limits<T>::max()} + 1>;

/// Of sRGB (IEC 61966-2-1), or of parts of the largest value.
template <typename T>
Decoded<T> decoded(bool is_srgb) noexcept {
    Decoded<T> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double x = static_cast<double>(i) / std::numeric_limits<T>::max();
        const double linear = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
        values[i] = static_cast<float>(is_srgb ? linear : x);
    }
    return values;
}

template <typename T>
const Decoded<T>& decoded_values(bool is_srgb) noexcept {
    static const std::array<Decoded<T>, 2> values{decoded<T>(false), decoded<T>(true)};
    return values[is_srgb ? 1 : 0];
}

/// Calls use(f) with a function f(i) of the colour of the texel of an index.
template <typename Use>
V3f with_texels(const Texture& t, const Use& use) noexcept {
    const auto decode = [&](const auto& texels, const auto& values) {
        if (t.channels == 1) return use([&](std::size_t i) { return V3f(values[texels[i]]); });
        return use([&](std::size_t i) {
            const auto* const rgb = texels.data() + 3 * i;
            return V3f(values[rgb[0]], values[rgb[1]], values[rgb[2]]);
        });
    };
    if (!t.texels.empty()) return use([&](std::size_t i) { return to_v3f(t.texels[i]); });
    if (!t.texels8.empty()) return decode(t.texels8, decoded_values<std::uint8_t>(t.is_srgb));
    return decode(t.texels16, decoded_values<std::uint16_t>(t.is_srgb));
}

}  // namespace

V3f lookup(const Texture& texture, const V2f& uv) noexcept {
    const V2f p = to_texels(texture, uv);
    const Tap x = tap(p.x - 0.5f, texture.width);
    const Tap y = tap(p.y - 0.5f, texture.height);
    const std::size_t first_row = std::size_t{y.first} * texture.width;
    const std::size_t second_row = std::size_t{y.second} * texture.width;
    return with_texels(texture, [&](const auto& texel_at) {
        const V3f top = texel_at(first_row + x.first) * (1.0f - x.weight) +
                        texel_at(first_row + x.second) * x.weight;
        const V3f bottom = texel_at(second_row + x.first) * (1.0f - x.weight) +
                           texel_at(second_row + x.second) * x.weight;
        return V3f(top * (1.0f - y.weight) + bottom * y.weight);
    });
}

V3f texel(const Texture& texture, std::uint32_t x, std::uint32_t y) noexcept {
    const std::size_t index = std::size_t{y} * texture.width + x;
    return with_texels(texture, [&](const auto& texel_at) { return V3f(texel_at(index)); });
}

std::size_t memory_size(const Texture& texture) noexcept {
    return size_of(texture.texels) + size_of(texture.texels8) + size_of(texture.texels16);
}

}  // namespace lightcull
