#pragma once

#include "render/vec.h"

#include <algorithm>
#include <cmath>

/// The terms of the GGX microfacet model (Walter et al. 2007), for surfaces and virtual lights.

namespace lightcull {

/// GGX's density of normals for a half vector by the squares of its sine and cosine to the normal:
/// 1 - cosine^2 would cancel.
inline float ggx(float sine2, float cosine2, float alpha) noexcept {
    const float a2 = alpha * alpha;
    const float d = sine2 / a2 + cosine2;
    return kInvPi / (a2 * d * d);
}

/// Smith's masking, divided by 2 cosine: 1 / (cosine + sqrt(alpha^2 + (1 - alpha^2) cosine^2)).
inline float masking_over_two_cosines(float cosine, float alpha) noexcept {
    const float a2 = alpha * alpha;
    return 1.0f / (cosine + std::sqrt(a2 + (1.0f - a2) * cosine * cosine));
}

/// Schlick's Fresnel term; f0: the reflectance at normal incidence.
inline V3f schlick(const V3f& f0, float cosine) noexcept {
    const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f);
    const float m2 = m * m;
    return f0 + (V3f(1.0f) - f0) * (m2 * m2 * m);
}

}  // namespace lightcull
