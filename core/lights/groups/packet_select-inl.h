// Included once per instruction set.
#if defined(LIGHTCULL_PACKET_SELECT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_PACKET_SELECT_INL
#undef LIGHTCULL_PACKET_SELECT_INL
#else
#define LIGHTCULL_PACKET_SELECT_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "lights/bvh/cluster_importance-inl.h"
#include "lights/groups/group_weigh-inl.h"
#include "lights/groups/packet_select.h"
#include "lights/light/receiver_lanes-inl.h"
#include "lights/ranges/sphere_tree_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace packet {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, ReceiverPacket::kSize>;
using Vec = hn::Vec<Tag>;
using TagU = hn::RebindToUnsigned<Tag>;
using Receivers = ReceiverLanes<Tag, ReceiverPacket>;
using Ways = cluster::Ways<Tag>;

/// Receivers of a packet and a slot of a node.
struct Encounter {
    Receivers receivers;
    Ways ways;
    Vec height;

    HWY_ATTR Encounter(const ReceiverPacket& packet, std::size_t i, float3 center)
        : receivers{packet, i},
          ways(receivers, hn::Set(Tag(), center.x), hn::Set(Tag(), center.y),
               hn::Set(Tag(), center.z)),
          height(ways.height_over(receivers)) {}

    /// True where a receiver is within the sphere, and what the slot holds is not below its
    /// horizon.
    HWY_ATTR hn::Mask<Tag> concerns(float radius, float bounds) const {
        const Tag d;
        const auto above = hn::Gt(hn::Add(height, hn::Set(d, bounds)),
                                  hn::Mul(hn::Set(d, walk::kHorizonOfNodes), receivers.horizon()));
        return hn::And(hn::Le(ways.distance2, hn::Set(d, radius * radius)), above);
    }
};

/// Adds a group to the reservoirs of those receivers that are within its range.
HWY_ATTR inline void weigh(const RangeTree& tree, const LightGroup& group, std::uint32_t record,
                           const PacketRandom& random, std::size_t i, const Encounter& met,
                           hn::Mask<Tag> in_range, PacketChoice& choice) {
    const Tag d;
    const TagU du;
    const auto reached = cluster::may_reach(d, group, 0, met.receivers, met.ways, met.height);
    const Vec g = cluster::mean_importance(d, group, 0, met.receivers, met.ways, met.height);
    const auto accepted = hn::And(hn::And(in_range, reached), hn::Gt(g, hn::Zero(d)));
    const Vec inverse_limit = hn::Set(d, 1.0f / tree.ranges().limit(group.intensity[0]));
    const Vec inverse_prob =
        groups::inverse_probs(d, met.ways.distance2, hn::Set(d, group.radius[0]), inverse_limit);
    const Vec weight = hn::IfThenElseZero(accepted, hn::Mul(g, inverse_prob));
    const Vec sum = hn::Add(hn::Load(d, choice.weight_sum + i), weight);
    hn::Store(sum, d, choice.weight_sum + i);
    const auto records = hn::Set(du, record);
    const Vec numbers = groups::random_numbers(d, hn::Load(du, random.u_bits + i), records);
    const auto chosen = hn::And(accepted, hn::Lt(hn::Mul(numbers, sum), weight));
    hn::Store(hn::IfThenElse(chosen, g, hn::Load(d, choice.numerator + i)), d,
              choice.numerator + i);
    hn::Store(hn::IfThenElse(hn::RebindMask(du, chosen), records, hn::Load(du, choice.record + i)),
              du, choice.record + i);
}

/// A mask in which bit s is set if the box of the receivers reaches into the sphere of slot s.
HWY_ATTR inline std::uint32_t slots_near(const SphereNode& node, const float* radii,
                                         const ReceiverPacket& packet) {
    const hn::CappedTag<float, SphereNode::kWidth> d;
    std::uint32_t bits = 0;
    for (std::size_t slot = 0; slot < SphereNode::kWidth; slot += hn::Lanes(d)) {
        const auto beyond = [&](const float* centers, float low, float high) HWY_ATTR {
            const auto c = hn::Load(d, centers + slot);
            return hn::Max(hn::Max(hn::Sub(hn::Set(d, low), c), hn::Sub(c, hn::Set(d, high))),
                           hn::Zero(d));
        };
        const auto dx = beyond(node.x, packet.low.x, packet.high.x);
        const auto dy = beyond(node.y, packet.low.y, packet.high.y);
        const auto dz = beyond(node.z, packet.low.z, packet.high.z);
        const auto distance2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
        const auto r = hn::LoadU(d, radii + slot);
        const auto within = hn::Le(distance2, hn::Mul(r, hn::Abs(r)));
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(d, within, bytes);
        bits |= std::uint32_t{bytes[0]} << slot;
    }
    return bits;
}

/// True if a slot concerns any of the receivers. A leaf is weighed for the receivers that it
/// concerns.
HWY_ATTR inline bool visit_slot(const RangeTree& ranged, const LightGroup* groups,
                                const SphereNode& node, std::uint32_t slot, float radius,
                                const ReceiverPacket& packet, const PacketRandom& random,
                                PacketChoice& choice) {
    const std::uint32_t link = node.link[slot];
    bool any = false;
    for (std::size_t i = 0; i < ReceiverPacket::kSize; i += hn::Lanes(Tag())) {
        const Encounter met(packet, i, node.center(slot));
        const auto concerned = met.concerns(radius, node.bounds[slot]);
        if (hn::AllFalse(Tag(), concerned)) continue;
        any = true;
        if ((link & SphereNode::kLeaf) == 0) break;
        const std::uint32_t record = link & ~SphereNode::kLeaf;
        weigh(ranged, groups[record], record, random, i, met, concerned, choice);
    }
    return any;
}

HWY_ATTR inline void prefetch(const SphereNode& node, const float* radii) {
    hwy::Prefetch(node.x);
    hwy::Prefetch(node.z);
    hwy::Prefetch(node.bounds);
    hwy::Prefetch(radii);
}

HWY_ATTR inline void select_packet(const RangeTree& ranged, const LightGroup* groups,
                                   const ReceiverPacket& packet, const PacketRandom& random,
                                   PacketChoice& choice) {
    const SphereTree& tree = ranged.tree();
    const float* radii = ranged.radii(packet.set);
    constexpr std::size_t kWidth = SphereNode::kWidth;
    const auto read = [&](std::uint32_t n, std::uint32_t* children) HWY_ATTR {
        const SphereNode& node = tree.nodes[n];
        const float* node_radii = radii + n * kWidth;
        std::uint32_t child_count = 0;
        for (std::uint32_t bits = slots_near(node, node_radii, packet); bits != 0;
             bits &= bits - 1) {
            const auto slot = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits));
            const float radius = node_radii[slot];
            if (!visit_slot(ranged, groups, node, slot, radius, packet, random, choice)) continue;
            const std::uint32_t link = node.link[slot];
            if ((link & SphereNode::kLeaf) != 0) continue;
            prefetch(tree.nodes[link], radii + link * kWidth);
            children[child_count++] = link;
        }
        return child_count;
    };
    TreeWalk walk(tree);
    while (!walk.over()) {
        const std::uint32_t n = walk.take();
        walk.add(read(n, walk.new_nodes()));
    }
}

}  // namespace packet
}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
