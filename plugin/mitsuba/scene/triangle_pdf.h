#pragma once

#include <drjit/array.h>

namespace mitsuba::culling {

/// Solid angle density of a point sampled uniformly on a triangle, seen from `distance` away along
/// `direction`.
template <typename Float, typename Normal, typename Vector>
Float triangle_pdf(const Float& area, const Normal& normal, const Vector& direction,
                   const Float& distance) {
    return drjit::square(distance) / (area * drjit::abs(drjit::dot(normal, direction)));
}

}  // namespace mitsuba::culling
