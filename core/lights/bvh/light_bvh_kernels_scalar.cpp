#define HWY_COMPILE_ONLY_SCALAR
#include "lights/bvh/light_bvh_kernels-inl.h"

namespace lightcull {

const LightBvhKernels<BoundsNode>& scalar_bounds_kernels() noexcept {
    return HWY_STATIC_DISPATCH(target_bounds_kernels)();
}

const LightBvhKernels<MeansNode>& scalar_means_kernels() noexcept {
    return HWY_STATIC_DISPATCH(target_means_kernels)();
}

}  // namespace lightcull
