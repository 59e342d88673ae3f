#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lights/ranges/range_kernels.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h, which includes this file once per instruction set.
#include "lights/ranges/range_kernels-inl.h"

#if HWY_ONCE

#include "lights/simd/dispatch.h"

namespace lightcull {

// Defined in range_kernels_scalar.cpp.
const RangeKernels& scalar_range_kernels() noexcept;

namespace {

HWY_EXPORT(target_range_kernels);

}  // namespace

const RangeKernels& range_kernels() noexcept {
    return kernels_in_use(HWY_DISPATCH_TABLE(target_range_kernels), scalar_range_kernels);
}

}  // namespace lightcull
#endif
