#pragma once

#include <mitsuba/render/interaction.h>

namespace mitsuba::culling {

/// The state of all paths of a wavefront that are still under way, a path for each lane.
template <typename Float_, typename Spectrum_>
struct PathStates {
    using Float = Float_;
    using Spectrum = Spectrum_;
    MI_IMPORT_TYPES(Shape)

    UInt32 path;    ///< its number in the whole wavefront
    UInt32 origin;  ///< the lane that it was in at the last bounce
    Ray3f ray;
    Spectrum throughput, result;
    Float eta;
    Mask valid;
    // The last vertex, for the weight of what its ray hits.
    Interaction3f last;
    Float bsdf_pdf;
    Mask weigh;

    // NOLINTNEXTLINE(performance-noexcept-move-constructor)
    DRJIT_STRUCT(PathStates, path, origin, ray, throughput, result, eta, valid, last, bsdf_pdf,
                 weigh)
};

}  // namespace mitsuba::culling
