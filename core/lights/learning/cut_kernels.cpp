#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lights/learning/cut_kernels.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h, which includes this file once per instruction set.
#include "lights/learning/cut_kernels-inl.h"

#if HWY_ONCE

#include "lights/simd/dispatch.h"

namespace lightcull {

// Defined in cut_kernels_scalar.cpp.
const CutKernels& scalar_cut_kernels() noexcept;

namespace {

HWY_EXPORT(target_cut_kernels);

}  // namespace

const CutKernels& cut_kernels() noexcept {
    return kernels_in_use(HWY_DISPATCH_TABLE(target_cut_kernels), scalar_cut_kernels);
}

}  // namespace lightcull
#endif
