#pragma once

#include "render/vec.h"

#include <lightcull/render/scene.h>

namespace lightcull {

/// A bilinear lookup, repeated in both directions.
V3f lookup(const Texture& texture, const V2f& uv) noexcept;

}  // namespace lightcull
