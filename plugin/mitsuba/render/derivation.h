#pragma once

#include <utility>

#include "loop/trace_loop.h"

namespace mitsuba::culling {

/// A step of computing derivatives: what sample() does where it would trace paths.
template <typename Float_, typename Spectrum_>
struct Derivation {
    using Float = Float_;
    using Spectrum = Spectrum_;
    MI_IMPORT_TYPES(Sampler)

    enum Step {
        kSplat,     ///< the light of each path is `change`, by which the image is derived
        kBackward,  ///< `change` is the gradient of what is derived, by the light of each path
        kForward,   ///< `change` is 0; the light of each path is its derivative
    };
    Step step;
    Spectrum change;

    std::pair<Spectrum, Mask> sample(const PathContext<Float, Spectrum>& context, Sampler* sampler,
                                     const RayDifferential3f& rays,
                                     const LightTables<Float, Spectrum>& tables,
                                     const LightBvhArrays<Float>& bvh, const Mask& active) const {
        if (step == kSplat) return {change, true};
        const auto mode = step == kBackward ? dr::ADMode::Backward : dr::ADMode::Forward;
        return {derive_loop(context, sampler, rays, tables, bvh, active, mode, change), true};
    }
};

/// Throws if a shape is to be derived by.
template <typename Float, typename Spectrum>
void refuse_moving_shapes(const Scene<Float, Spectrum>* scene) {
    for (const auto& shape : scene->shapes()) {
        if (shape->parameters_grad_enabled()) {
            Throw(
                "lightcull_path has no derivatives by the form or place of shapes (\"%s\"): what "
                "they hide changes, for which there is Mitsuba's prb_projective",
                shape->id());
        }
    }
}

}  // namespace mitsuba::culling
