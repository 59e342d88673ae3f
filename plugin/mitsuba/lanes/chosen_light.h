#pragma once

#include <drjit/array.h>

namespace mitsuba::culling {

/// The light that was chosen for each lane.
template <typename Float_>
struct ChosenLight {
    using Float = Float_;
    drjit::uint32_array_t<Float> light;
    Float prob;      ///< 0: none
    Float mis_prob;  ///< the probability that stands for it in weights
};

}  // namespace mitsuba::culling
