// Included once per instruction set.
#if defined(LIGHTCULL_SPHERE_TREE_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_SPHERE_TREE_WALK_INL
#undef LIGHTCULL_SPHERE_TREE_WALK_INL
#else
#define LIGHTCULL_SPHERE_TREE_WALK_INL
#endif

#include <hwy/highway.h>

#include "lights/ranges/sphere_tree_walk.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace walk {
namespace hn = hwy::HWY_NAMESPACE;

/// A node is skipped where it lies lower than this multiple of the horizon of lights, which allows
/// for rounding.
constexpr float kHorizonOfNodes = 2.0f;

/// A mask of the slots of a vector in whose spheres the point is, and which hold something that is
/// not below the point's horizon.
template <class D>
HWY_ATTR HWY_INLINE hn::Mask<D> concerns(D d, const SphereNode& node, const float* radii,
                                         std::size_t slot, const Receiver& receiver) {
    const auto dx = hn::Sub(hn::Load(d, node.x + slot), hn::Set(d, receiver.position.x));
    const auto dy = hn::Sub(hn::Load(d, node.y + slot), hn::Set(d, receiver.position.y));
    const auto dz = hn::Sub(hn::Load(d, node.z + slot), hn::Set(d, receiver.position.z));
    const auto distance2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
    const auto r = hn::LoadU(d, radii + slot);
    // The square is r |r|: the radius of an empty slot is negative.
    const auto within = hn::Le(distance2, hn::Mul(r, hn::Abs(r)));
    const auto height = hn::Add(hn::Add(hn::Mul(dx, hn::Set(d, receiver.normal.x)),
                                        hn::Mul(dy, hn::Set(d, receiver.normal.y))),
                                hn::Mul(dz, hn::Set(d, receiver.normal.z)));
    const auto above = hn::Gt(hn::Add(height, hn::Load(d, node.bounds + slot)),
                              hn::Set(d, kHorizonOfNodes * receiver.horizon));
    return hn::And(within, above);
}

HWY_ATTR inline void find_leaves(const SphereTree& tree, const float* radii,
                                 const Receiver& receiver, TreeWalk& walk, FoundLeaves& found) {
    constexpr std::size_t kWidth = SphereNode::kWidth;
    const hn::CappedTag<float, kWidth> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    const auto leaf_bit = hn::Set(du, SphereNode::kLeaf);
    std::uint32_t count = 0;
    while (!walk.over() && count + kWidth <= FoundLeaves::kCapacity) {
        const std::uint32_t n = walk.take();
        const SphereNode& node = tree.nodes[n];
        const float* node_radii = radii + std::size_t{n} * kWidth;
        std::uint32_t* children = walk.new_nodes();
        std::uint32_t child_count = 0;
        // The loop has no branch for each slot: which of them hold the point cannot be predicted.
        for (std::size_t slot = 0; slot < kWidth; slot += hn::Lanes(d)) {
            const auto link = hn::Load(du, node.link + slot);
            const auto inside = hn::RebindMask(du, concerns(d, node, node_radii, slot, receiver));
            const auto leaf = hn::TestBit(link, leaf_bit);
            const auto leaves = hn::And(inside, leaf), nodes = hn::AndNot(leaf, inside);
            hn::StoreU(hn::Compress(hn::AndNot(leaf_bit, link), leaves), du, found.records + count);
            count += static_cast<std::uint32_t>(hn::CountTrue(du, leaves));
            hn::StoreU(hn::Compress(link, nodes), du, children + child_count);
            child_count += static_cast<std::uint32_t>(hn::CountTrue(du, nodes));
        }
        walk.add(child_count);
        ++found.nodes_visited;
    }
    found.count = count;
}

}  // namespace walk
}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
