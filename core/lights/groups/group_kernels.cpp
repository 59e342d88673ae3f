#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lights/groups/group_kernels.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h, which includes this file once per instruction set.
#include "lights/groups/group_kernels-inl.h"

#if HWY_ONCE

#include "lights/simd/dispatch.h"

namespace lightcull {

// Defined in group_kernels_scalar.cpp.
const GroupKernels& scalar_group_kernels() noexcept;

namespace {

HWY_EXPORT(target_group_kernels);

}  // namespace

const GroupKernels& group_kernels() noexcept {
    return kernels_in_use(HWY_DISPATCH_TABLE(target_group_kernels), scalar_group_kernels);
}

}  // namespace lightcull
#endif
