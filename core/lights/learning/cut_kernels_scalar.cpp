#define HWY_COMPILE_ONLY_SCALAR
#include "lights/learning/cut_kernels-inl.h"

namespace lightcull {

const CutKernels& scalar_cut_kernels() noexcept {
    return HWY_STATIC_DISPATCH(target_cut_kernels)();
}

}  // namespace lightcull
