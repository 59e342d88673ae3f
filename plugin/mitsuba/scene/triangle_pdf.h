#pragma once

#include <drjit/array.h>

namespace mitsuba::culling {

/// The solid angle density (1/sr) of a point that is sampled on a triangle of unit `normal` with
/// `density` by area (1/m^2), seen from `distance` away along the unit `direction`.
template <typename Float, typename Normal, typename Vector>
Float triangle_pdf(const Float& density, const Normal& normal, const Vector& direction,
                   const Float& distance) {
    return density * drjit::square(distance) / drjit::abs(drjit::dot(normal, direction));
}

}  // namespace mitsuba::culling
