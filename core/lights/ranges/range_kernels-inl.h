// Included once per instruction set.
#if defined(LIGHTCULL_RANGE_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_RANGE_KERNELS_INL
#undef LIGHTCULL_RANGE_KERNELS_INL
#else
#define LIGHTCULL_RANGE_KERNELS_INL
#endif

#include <hwy/highway.h>

#include "lights/ranges/range_kernels.h"
#include "lights/ranges/sphere_tree_refit-inl.h"
#include "lights/ranges/sphere_tree_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {

constexpr RangeKernels kRangeKernels{walk::find_leaves, refit::refit_nodes};

inline const RangeKernels& target_range_kernels() {
    return kRangeKernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
