#pragma once

#include <drjit/array_traits.h>

#include <mutex>

namespace mitsuba::culling {

inline std::mutex one_at_a_time;

/// Held while a render of an LLVM variant runs, so that there is but one at a time; others go on
/// at once. Dr.Jit (1.3.1) keeps one queue of kernels for all threads, and where several wait for
/// it again and again, as between the bounces of a wavefront, it loses track of what still runs.
/// Kernels use all processors, so that renders that take turns lose little.
template <typename Float>
std::unique_lock<std::mutex> take_turn() {
    if constexpr (drjit::is_jit_v<Float>) {
        return std::unique_lock(one_at_a_time);
    } else {
        return {};
    }
}

}  // namespace mitsuba::culling
