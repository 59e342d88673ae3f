#define HWY_COMPILE_ONLY_SCALAR
#include "lights/simd/kernels-inl.h"

namespace lightcull {

const Kernels& scalar_kernels() noexcept {
    return *HWY_STATIC_DISPATCH(target_kernels)();
}

}  // namespace lightcull
