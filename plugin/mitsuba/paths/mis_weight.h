#pragma once

#include <drjit/array.h>

namespace mitsuba::culling {

/// The weight of multiple importance sampling by the power heuristic, for a sample that its own
/// technique takes with density `pdf` and the other one with `other_pdf`; 0 where neither can.
template <typename Float>
Float mis_weight(const Float& pdf, const Float& other_pdf) {
    const Float a = drjit::square(pdf), b = drjit::square(other_pdf), weight = a / (a + b);
    return drjit::select(drjit::isfinite(weight), weight, 0.0f);
}

}  // namespace mitsuba::culling
