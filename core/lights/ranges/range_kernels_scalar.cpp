#define HWY_COMPILE_ONLY_SCALAR
#include "lights/ranges/range_kernels-inl.h"

namespace lightcull {

const RangeKernels& scalar_range_kernels() noexcept {
    return HWY_STATIC_DISPATCH(target_range_kernels)();
}

}  // namespace lightcull
