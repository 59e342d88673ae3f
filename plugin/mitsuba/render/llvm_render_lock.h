#pragma once

#include <drjit/array_traits.h>

#include <mutex>

namespace mitsuba::culling {

inline std::mutex llvm_render_mutex;

/// The lock that a render holds, so that LLVM variants render one scene at a time; scalar variants
/// need not wait. Dr.Jit (1.3.1) keeps one queue of kernels for all threads, and where several
/// threads wait for it again and again, as between the bounces of a wavefront, it loses track of
/// what still runs. Kernels use all processors, so that little is lost.
template <typename Float>
std::unique_lock<std::mutex> lock_llvm_render() {
    if constexpr (drjit::is_jit_v<Float>) {
        return std::unique_lock(llvm_render_mutex);
    } else {
        return {};
    }
}

}  // namespace mitsuba::culling
