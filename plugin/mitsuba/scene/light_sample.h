#pragma once

#include <mitsuba/render/interaction.h>
#include <mitsuba/render/shape.h>

namespace mitsuba::culling {

/// A point on a light, or a direction to it; in LLVM variants one for each lane.
template <typename Float_, typename Spectrum_>
struct LightSample {
    using Float = Float_;
    using Spectrum = Spectrum_;
    MI_IMPORT_TYPES(Shape)

    Point3f p;
    Vector3f direction;
    Spectrum weight;  ///< radiance divided by the density of the sample
    Float pdf;        ///< the density that stands for it in weights
    Mask delta, active;

    // NOLINTNEXTLINE(performance-noexcept-move-constructor)
    DRJIT_STRUCT(LightSample, p, direction, weight, pdf, delta, active)
};

}  // namespace mitsuba::culling
