#define HWY_COMPILE_ONLY_SCALAR
#include "lights/groups/group_kernels-inl.h"

namespace lightcull {

const GroupKernels& scalar_group_kernels() noexcept {
    return HWY_STATIC_DISPATCH(target_group_kernels)();
}

}  // namespace lightcull
