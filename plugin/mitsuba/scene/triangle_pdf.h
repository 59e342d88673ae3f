#pragma once

#include <drjit/array.h>

namespace mitsuba::culling {

/// The solid angle density (1/sr) of a point sampled uniformly on a triangle of `area` and unit
/// `normal`, seen from `distance` away along the unit `direction`.
template <typename Float, typename Normal, typename Vector>
Float triangle_pdf(const Float& area, const Normal& normal, const Vector& direction,
                   const Float& distance) {
    return drjit::square(distance) / (area * drjit::abs(drjit::dot(normal, direction)));
}

}  // namespace mitsuba::culling
