#pragma once

#include "render/vec.h"

#include <lightcull/render/scene.h>

namespace lightcull {

/// A bilinear lookup, repeated in both directions.
V3f lookup(const Texture& texture, const V2f& uv) noexcept;

/// The mean luminance of the texture over a triangle in texture space. It is 0 only where no lookup
/// in the triangle can give anything else.
float mean_luminance(const Texture& texture, const V2f& a, const V2f& b, const V2f& c);

}  // namespace lightcull
