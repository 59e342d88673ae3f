// Included once per instruction set.
#if defined(LIGHTCULL_LIGHT_BVH_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_LIGHT_BVH_KERNELS_INL
#undef LIGHTCULL_LIGHT_BVH_KERNELS_INL
#else
#define LIGHTCULL_LIGHT_BVH_KERNELS_INL
#endif

#include <hwy/highway.h>

#include "lights/bvh/light_bvh_descend-inl.h"
#include "lights/bvh/light_bvh_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {

template <typename Node>
constexpr LightBvhKernels<Node> kLightBvhKernels{bvh::compute_importances, bvh::descend<Node>,
                                                 bvh::prob_of_slot<Node>};

inline const LightBvhKernels<BoundsNode>& target_bounds_kernels() {
    return kLightBvhKernels<BoundsNode>;
}
inline const LightBvhKernels<MeansNode>& target_means_kernels() {
    return kLightBvhKernels<MeansNode>;
}

}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
