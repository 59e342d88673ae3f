#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lights/bvh/light_bvh_kernels.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h, which includes this file once per instruction set.
#include "lights/bvh/light_bvh_kernels-inl.h"

#if HWY_ONCE

#include "lights/simd/dispatch.h"

namespace lightcull {

// Defined in light_bvh_kernels_scalar.cpp.
const LightBvhKernels<BoundsNode>& scalar_bounds_kernels() noexcept;
const LightBvhKernels<MeansNode>& scalar_means_kernels() noexcept;

namespace {

HWY_EXPORT(target_bounds_kernels);
HWY_EXPORT(target_means_kernels);

}  // namespace

template <>
const LightBvhKernels<BoundsNode>& light_bvh_kernels() noexcept {
    return kernels_in_use(HWY_DISPATCH_TABLE(target_bounds_kernels), scalar_bounds_kernels);
}

template <>
const LightBvhKernels<MeansNode>& light_bvh_kernels() noexcept {
    return kernels_in_use(HWY_DISPATCH_TABLE(target_means_kernels), scalar_means_kernels);
}

}  // namespace lightcull
#endif
