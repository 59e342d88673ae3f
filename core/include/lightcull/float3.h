#pragma once

namespace lightcull {

/// Two floats: texture coordinates.
struct float2 {
    float x = 0.0f, y = 0.0f;
};

/// Three floats: a position in metres, a direction, or linear RGB.
struct float3 {
    float x = 0.0f, y = 0.0f, z = 0.0f;
};

static_assert(sizeof(float3) == 12, "arrays of float3 are read as (N, 3) float arrays");

}  // namespace lightcull
