#pragma once

#include "base/core_export.h"
#include "render/vec.h"

#include <lightcull/render/scene.h>

#include <cstddef>
#include <cstdint>

namespace lightcull {

/// A bilinear lookup, repeated in both directions.
LIGHTCULL_CORE_EXPORT V3f lookup(const Texture& texture, const V2f& uv) noexcept;

/// A texel as linear RGB.
LIGHTCULL_CORE_EXPORT V3f texel(const Texture& texture, std::uint32_t x, std::uint32_t y) noexcept;

/// The bytes of all texels.
std::size_t memory_size(const Texture& texture) noexcept;

}  // namespace lightcull
