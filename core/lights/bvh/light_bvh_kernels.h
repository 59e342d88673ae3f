#pragma once

#include <lightcull/span.h>

#include <cstddef>

#include "lights/bvh/light_bvh.h"
#include "lights/bvh/light_bvh_descend.h"

namespace lightcull {

/// The work that is done with a light BVH, for one instruction set; all of them give the same bits.
template <typename Node>
struct LightBvhKernels {
    void (*importances)(const Node& node, const Receiver& receiver, float* result);

    /// Takes each descent that is not at a light to one, or to prob 0; at most kMaxDescents. Many
    /// descents cost less together than one after the other: one computes while others wait for
    /// memory.
    void (*descend)(const LightBvh<Node>& bvh, Span<LightBvhDescent> descents);

    /// The probability of what a slot holds, if that of what `top` holds is `prob`: to the bit what
    /// a descent finds that takes it. top: the slot itself or one above it; kNoSlot: the root is
    /// reached with `prob`.
    double (*prob_of_slot)(const LightBvh<Node>& bvh, const Receiver& receiver, LightBvhSlot slot,
                           LightBvhSlot top, double prob);
};

/// The kernels for the instruction set in use.
template <typename Node>
const LightBvhKernels<Node>& light_bvh_kernels() noexcept;
template <>
const LightBvhKernels<BoundsNode>& light_bvh_kernels() noexcept;
template <>
const LightBvhKernels<MeansNode>& light_bvh_kernels() noexcept;

}  // namespace lightcull
