// Included once per instruction set.
#if defined(LIGHTCULL_SPHERE_TREE_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_SPHERE_TREE_WALK_INL
#undef LIGHTCULL_SPHERE_TREE_WALK_INL
#else
#define LIGHTCULL_SPHERE_TREE_WALK_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cassert>

#include "lights/sphere_tree_walk.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace walk {
namespace hn = hwy::HWY_NAMESPACE;

HWY_ATTR inline void prefetch(const SphereNode& node, const float* radii) {
    hwy::Prefetch(node.x);
    hwy::Prefetch(node.z);
    hwy::Prefetch(node.bounds);
    hwy::Prefetch(radii);
}

/// A node is skipped where it lies this many times the horizon of lights low: rounding allowed for.
constexpr float kHorizonOfNodes = 2.0f;

/// Bit s is set if the point is within the sphere of slot s, and what the slot holds is not below
/// the point's horizon.
HWY_ATTR inline std::uint32_t slots_around(const SphereNode& node, const float* radii,
                                           const LightBvhPoint& point) {
    const hn::CappedTag<float, SphereNode::kWidth> d;
    std::uint32_t bits = 0;
    for (std::size_t slot = 0; slot < SphereNode::kWidth; slot += hn::Lanes(d)) {
        const auto dx = hn::Sub(hn::Load(d, node.x + slot), hn::Set(d, point.position.x));
        const auto dy = hn::Sub(hn::Load(d, node.y + slot), hn::Set(d, point.position.y));
        const auto dz = hn::Sub(hn::Load(d, node.z + slot), hn::Set(d, point.position.z));
        const auto distance2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
        const auto r = hn::LoadU(d, radii + slot);
        // r |r|: the radius of an empty slot is negative.
        const auto within = hn::Le(distance2, hn::Mul(r, hn::Abs(r)));
        const auto height = hn::Add(hn::Add(hn::Mul(dx, hn::Set(d, point.normal.x)),
                                            hn::Mul(dy, hn::Set(d, point.normal.y))),
                                    hn::Mul(dz, hn::Set(d, point.normal.z)));
        const auto above = hn::Gt(hn::Add(height, hn::Load(d, node.bounds + slot)),
                                  hn::Set(d, kHorizonOfNodes * point.horizon));
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(d, hn::And(within, above), bytes);
        bits |= std::uint32_t{bytes[0]} << slot;
    }
    return bits;
}

HWY_ATTR inline void find_leaves(const SphereTree& tree, const float* radii,
                                 const LightBvhPoint& point, TreeWalk& state, FoundLeaves& found) {
    std::uint32_t found_count = 0, stack_size = state.stack_size;
    while (stack_size > 0 && found_count + SphereNode::kWidth <= FoundLeaves::kCapacity) {
        const std::uint32_t n = state.stack[--stack_size];
        const SphereNode& node = tree.nodes[n];
        ++state.nodes_visited;
        std::uint32_t bits = slots_around(node, radii + std::size_t{n} * SphereNode::kWidth, point);
        assert(stack_size + SphereNode::kWidth <= TreeWalk::kStackSize);
        for (; bits != 0; bits &= bits - 1) {
            const std::uint32_t link = node.link[hwy::Num0BitsBelowLS1Bit_Nonzero32(bits)];
            // Written to both, kept in one: which of the two cannot be predicted.
            const std::uint32_t is_leaf = link >> 31;
            found.records[found_count] = link & ~SphereNode::kLeaf;
            state.stack[stack_size] = link;
            if (is_leaf == 0) {
                prefetch(tree.nodes[link], radii + std::size_t{link} * SphereNode::kWidth);
            } else {
                hwy::Prefetch(&tree.records[link & ~SphereNode::kLeaf]);
            }
            found_count += is_leaf;
            stack_size += 1 - is_leaf;
        }
    }
    state.stack_size = stack_size;
    found.count = found_count;
}

}  // namespace walk
}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
