// Included once per instruction set.
#if defined(LIGHTCULL_PACKET_SELECT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_PACKET_SELECT_INL
#undef LIGHTCULL_PACKET_SELECT_INL
#else
#define LIGHTCULL_PACKET_SELECT_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "lights/light_groups.h"
#include "lights/packet_select.h"
#include "lights/range_tree.h"
#include "lights/reservoir.h"
#include "lights/sphere_tree_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace packet {
namespace hn = hwy::HWY_NAMESPACE;

// Everything here repeats ranges.h, light_groups.cpp and reservoir.h, operation by operation.

using Tag = hn::CappedTag<float, PointPacket::kSize>;
using Vec = hn::Vec<Tag>;
using TagU = hn::RebindToUnsigned<Tag>;

HWY_ATTR inline Vec constant(float value) {
    return hn::Set(Tag(), value);
}
HWY_ATTR inline Vec dot(Vec ax, Vec ay, Vec az, Vec bx, Vec by, Vec bz) {
    return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}
/// The way from each of a vector of points to a light.
struct Ways {
    Vec x, y, z, distance2;

    HWY_ATTR Ways(const PointPacket& points, std::size_t i, float3 center)
        : x(hn::Sub(constant(center.x), hn::Load(Tag(), points.x + i))),
          y(hn::Sub(constant(center.y), hn::Load(Tag(), points.y + i))),
          z(hn::Sub(constant(center.z), hn::Load(Tag(), points.z + i))),
          distance2(dot(x, y, z, x, y, z)) {}
    HWY_ATTR Vec dot_with(float3 v) const {
        return dot(constant(v.x), constant(v.y), constant(v.z), x, y, z);
    }
    HWY_ATTR Vec dot_with(const float* vx, const float* vy, const float* vz) const {
        return dot(hn::Load(Tag(), vx), hn::Load(Tag(), vy), hn::Load(Tag(), vz), x, y, z);
    }
};

/// c + sqrt(c^2 + q).
HWY_ATTR inline Vec softened(Vec c, Vec q) {
    return hn::Add(c, hn::Sqrt(hn::Add(hn::Mul(c, c), q)));
}

/// Of a two-sided group the larger one of c and -c, else -c.
HWY_ATTR inline Vec one_or_both(Vec c, bool two_sided) {
    return two_sided ? hn::Max(hn::Neg(c), c) : hn::Neg(c);
}

/// What `received` becomes with the receivers' lobes.
HWY_ATTR HWY_NOINLINE inline Vec with_lobes(const PointPacket& points, std::size_t i,
                                            const Ways& ways, Vec mean_distance2, Vec spread,
                                            Vec received) {
    const Tag d;
    const Vec one = constant(1.0f), half = constant(0.5f);
    const Vec root = hn::Sqrt(mean_distance2);
    const Vec inverse_root = hn::Div(one, root);
    const Vec cosine = hn::Mul(
        ways.dot_with(points.lobe_x + i, points.lobe_y + i, points.lobe_z + i), inverse_root);
    const Vec alpha2 = hn::Load(d, points.alpha2 + i), peak = hn::Load(d, points.peak + i);
    const Vec angular_spread = hn::Mul(hn::Mul(spread, inverse_root), inverse_root);
    const Vec width = hn::Add(alpha2, hn::Mul(constant(0.25f), angular_spread));
    const Vec inverse_sum = hn::Div(one, hn::Add(width, hn::Mul(half, hn::Sub(one, cosine))));
    const Vec lobe =
        hn::Mul(hn::Mul(hn::Mul(hn::Mul(peak, alpha2), width), inverse_sum), inverse_sum);
    const Vec diffuse =
        hn::Mul(hn::Load(d, points.diffuse + i), hn::Mul(hn::Mul(half, received), inverse_root));
    const Vec both = hn::Mul(hn::Add(root, root), hn::Add(diffuse, lobe));
    return hn::IfThenElse(hn::Gt(peak, constant(0.0f)), both, received);
}

/// The gates of importance(): where any of the group may reach the points.
HWY_ATTR inline hn::Mask<Tag> may_reach(const LightGroup& group, const PointPacket& points,
                                        std::size_t i, const Ways& ways, Vec height) {
    const Vec along = one_or_both(ways.dot_with(group.axis), std::signbit(group.diffuse));
    const Vec apex = constant(group.apex);
    const Vec from_apex = hn::Add(along, apex);
    const Vec from_apex2 = hn::Add(ways.distance2, hn::Mul(apex, hn::Add(along, from_apex)));
    const auto inside =
        hn::Ge(hn::Mul(from_apex, hn::Abs(from_apex)), hn::Mul(constant(group.cosine), from_apex2));
    const auto above =
        hn::Gt(hn::Add(height, constant(group.radius)), hn::Load(Tag(), points.horizon + i));
    return hn::And(above, inside);
}

/// importance() behind its gates.
HWY_ATTR inline Vec importances(const LightGroup& group, const PointPacket& points, std::size_t i,
                                const Ways& ways, Vec height) {
    const float signed_spread = group.spread;
    const Vec spread = constant(std::abs(signed_spread));
    const Vec mean_distance2 = hn::Add(ways.distance2, spread);
    Vec received = softened(
        height,
        hn::Add(spread, hn::Mul(hn::Load(Tag(), points.from_all_sides + i), mean_distance2)));
    if (points.has_lobes) {
        received = with_lobes(points, i, ways, mean_distance2, spread, received);
    }
    const Vec facing = one_or_both(ways.dot_with(group.mean_normal), std::signbit(group.diffuse));
    const Vec emitted =
        softened(facing, hn::Add(constant(std::max(signed_spread, 0.0f)),
                                 hn::Mul(constant(std::abs(group.diffuse)), mean_distance2)));
    const Vec inverse = hn::Div(constant(1.0f), mean_distance2);
    return hn::Mul(hn::Mul(constant(group.intensity), hn::Mul(received, inverse)),
                   hn::Mul(emitted, inverse));
}

/// The random numbers of Reservoir::add().
HWY_ATTR inline Vec random_numbers(const PointPacket& points, std::size_t i, std::uint32_t record) {
    const TagU d;
    auto bits = hn::Xor(hn::Load(d, points.u_bits + i), hn::Set(d, record * Reservoir::kStride));
    bits = hn::Mul(hn::Xor(bits, hn::ShiftRight<16>(bits)), hn::Set(d, 0x85ebca6bu));
    bits = hn::Mul(hn::Xor(bits, hn::ShiftRight<13>(bits)), hn::Set(d, 0xc2b2ae35u));
    bits = hn::Xor(bits, hn::ShiftRight<16>(bits));
    // Halves are exact as floats, so their sum is rounded once, as a conversion would be.
    const hn::RebindToSigned<Tag> signed_d;
    const Vec high = hn::ConvertTo(Tag(), hn::BitCast(signed_d, hn::ShiftRight<16>(bits)));
    const Vec low = hn::ConvertTo(Tag(), hn::BitCast(signed_d, hn::And(bits, hn::Set(d, 0xffffu))));
    const Vec number = hn::Add(hn::Mul(high, constant(0x1p16f)), low);
    return hn::Min(hn::Mul(number, constant(0x1p-32f)), constant(Reservoir::kBelowOne));
}

/// Adds a group to the reservoirs of those points that are within its sphere.
HWY_ATTR inline void weigh(const RangeTree& tree, const LightGroup& group, std::uint32_t record,
                           float sphere_radius, const PointPacket& points, PacketChoice& choice) {
    const Vec limit2 = constant(sphere_radius * sphere_radius);
    const Vec inverse_limit = constant(1.0f / tree.ranges().limit(group.intensity));
    for (std::size_t i = 0; i < PointPacket::kSize; i += hn::Lanes(Tag())) {
        const Ways ways(points, i, group.center);
        const Vec height =
            ways.dot_with(points.normal_x + i, points.normal_y + i, points.normal_z + i);
        const auto in_range =
            hn::And(hn::Le(ways.distance2, limit2), may_reach(group, points, i, ways, height));
        if (hn::AllFalse(Tag(), in_range)) continue;
        const Vec g = importances(group, points, i, ways, height);
        const auto accepted = hn::And(in_range, hn::Gt(g, constant(0.0f)));

        const Vec distance =
            hn::Max(hn::Sub(hn::Sqrt(ways.distance2), constant(group.radius)), constant(0.0f));
        const Vec inverse_prob =
            hn::Max(hn::Mul(hn::Mul(distance, distance), inverse_limit), constant(1.0f));
        const Vec weight = hn::IfThenElseZero(accepted, hn::Mul(g, inverse_prob));
        const Vec sum = hn::Add(hn::Load(Tag(), choice.weight_sum + i), weight);
        hn::Store(sum, Tag(), choice.weight_sum + i);
        const Vec random = random_numbers(points, i, record);
        const auto chosen = hn::And(accepted, hn::Lt(hn::Mul(random, sum), weight));
        hn::Store(hn::IfThenElse(chosen, g, hn::Load(Tag(), choice.numerator + i)), Tag(),
                  choice.numerator + i);
        const TagU d;
        hn::Store(hn::IfThenElse(hn::RebindMask(d, chosen), hn::Set(d, record),
                                 hn::Load(d, choice.record + i)),
                  d, choice.record + i);
    }
}

/// Bit s is set if the box of the points reaches into the sphere of slot s.
HWY_ATTR inline std::uint32_t slots_near(const SphereNode& node, const float* radii,
                                         const PointPacket& points) {
    const hn::CappedTag<float, SphereNode::kWidth> d;
    std::uint32_t bits = 0;
    for (std::size_t slot = 0; slot < SphereNode::kWidth; slot += hn::Lanes(d)) {
        const auto beyond = [&](const float* centers, float low, float high) HWY_ATTR {
            const auto c = hn::Load(d, centers + slot);
            return hn::Max(hn::Max(hn::Sub(hn::Set(d, low), c), hn::Sub(c, hn::Set(d, high))),
                           hn::Zero(d));
        };
        const auto dx = beyond(node.x, points.low.x, points.high.x);
        const auto dy = beyond(node.y, points.low.y, points.high.y);
        const auto dz = beyond(node.z, points.low.z, points.high.z);
        const auto distance2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
        const auto r = hn::LoadU(d, radii + slot);
        const auto within = hn::Le(distance2, hn::Mul(r, hn::Abs(r)));
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(d, within, bytes);
        bits |= std::uint32_t{bytes[0]} << slot;
    }
    return bits;
}

/// Whether any of the points is within the sphere of a slot, and what it holds is not below the
/// point's horizon.
HWY_ATTR inline bool concerns_any(const PointPacket& points, const SphereNode& node,
                                  std::uint32_t slot, float radius) {
    const Vec limit = constant(radius * radius), bounds = constant(node.bounds[slot]);
    for (std::size_t i = 0; i < PointPacket::kSize; i += hn::Lanes(Tag())) {
        const Ways ways(points, i, node.center(slot));
        const Vec height =
            ways.dot_with(points.normal_x + i, points.normal_y + i, points.normal_z + i);
        const Vec horizon = hn::Load(Tag(), points.horizon + i);
        const auto above =
            hn::Gt(hn::Add(height, bounds), hn::Mul(constant(walk::kHorizonOfNodes), horizon));
        if (!hn::AllFalse(Tag(), hn::And(hn::Le(ways.distance2, limit), above))) return true;
    }
    return false;
}

/// Groups that are to be weighed once they have come from memory.
struct Waiting {
    std::uint32_t records[SphereNode::kWidth];
    float radii[SphereNode::kWidth];
    std::uint32_t count = 0;
};

HWY_ATTR inline void select_packet(const RangeTree& ranged, const LightGroup* groups,
                                   const PointPacket& points, PacketChoice& choice) {
    const SphereTree& tree = ranged.tree();
    const float* radii = ranged.radii(points.set);
    constexpr std::size_t kWidth = SphereNode::kWidth;
    std::uint32_t stack[TreeWalk::kStackSize];
    std::uint32_t stack_size = 0;
    if (!tree.empty()) stack[stack_size++] = 0;
    // What one node adds is weighed after the next is read.
    Waiting lists[2];
    std::uint32_t parity = 0;
    const auto weigh_all = [&](Waiting& waiting) HWY_ATTR {
        for (std::uint32_t i = 0; i < waiting.count; ++i) {
            const std::uint32_t record = waiting.records[i];
            weigh(ranged, groups[record], record, waiting.radii[i], points, choice);
        }
        waiting.count = 0;
    };
    while (stack_size > 0) {
        const std::uint32_t n = stack[--stack_size];
        const SphereNode& node = tree.nodes[n];
        Waiting& found = lists[parity];
        parity ^= 1;
        const float* node_radii = radii + n * kWidth;
        assert(stack_size + kWidth <= TreeWalk::kStackSize);
        for (std::uint32_t bits = slots_near(node, node_radii, points); bits != 0;
             bits &= bits - 1) {
            const auto slot = static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits));
            if (!concerns_any(points, node, slot, node_radii[slot])) continue;
            const std::uint32_t link = node.link[slot];
            if ((link & SphereNode::kLeaf) != 0) {
                const std::uint32_t record = link & ~SphereNode::kLeaf;
                hwy::Prefetch(groups + record);
                found.records[found.count] = record;
                found.radii[found.count++] = node_radii[slot];
                continue;
            }
            walk::prefetch(tree.nodes[link], radii + link * kWidth);
            stack[stack_size++] = link;
        }
        weigh_all(lists[parity]);
    }
    weigh_all(lists[parity ^ 1]);
}

}  // namespace packet
}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
