// Included once per instruction set.
#if defined(LIGHTCULL_PACKET_SELECT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_PACKET_SELECT_INL
#undef LIGHTCULL_PACKET_SELECT_INL
#else
#define LIGHTCULL_PACKET_SELECT_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cassert>

#include "lights/culling_tree.h"
#include "lights/packet_select.h"
#include "lights/reservoir.h"
#include "lights/sphere_tree_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace packet {
namespace hn = hwy::HWY_NAMESPACE;

// Everything here repeats ranges.h, importance.h and reservoir.h, operation by operation.

using Tag = hn::CappedTag<float, PointPacket::kSize>;
using Vec = hn::Vec<Tag>;
using TagU = hn::RebindToUnsigned<Tag>;

HWY_ATTR inline Vec constant(float value) {
    return hn::Set(Tag(), value);
}
HWY_ATTR inline Vec dot(Vec ax, Vec ay, Vec az, Vec bx, Vec by, Vec bz) {
    return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}
HWY_ATTR inline Vec sine_of(Vec cosine) {
    return hn::Sqrt(hn::Max(constant(0.0f), hn::Sub(constant(1.0f), hn::Mul(cosine, cosine))));
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

/// emitter_bound(), and 1 within the sphere.
HWY_ATTR HWY_NOINLINE inline Vec emitter_bounds(const LightRecord& light, const Ways& ways) {
    const Vec zero = constant(0.0f), one = constant(1.0f);
    const Vec distance = hn::Sqrt(ways.distance2);
    const Vec inverse = hn::IfThenElseZero(hn::Gt(distance, zero), hn::Div(one, distance));
    const float3 axis = axis_of(light);
    const Vec along =
        dot(constant(axis.x), constant(axis.y), constant(axis.z), hn::Mul(ways.x, inverse),
            hn::Mul(ways.y, inverse), hn::Mul(ways.z, inverse));
    Vec cosine = hn::Min(hn::Max(hn::Neg(along), constant(-1.0f)), one);
    if (light.two_sided != 0) cosine = hn::Abs(cosine);

    const Angle theta_o =
        Angle::from_cosine(static_cast<float>(light.cos_theta_o) * LightRecord::kSnorm);
    const Vec o_sine = constant(theta_o.sine), o_cosine = constant(theta_o.cosine);
    const Vec sine = sine_of(cosine);
    const auto in_cone = hn::Ge(cosine, o_cosine);
    const Vec normal_sine =
        hn::IfThenZeroElse(in_cone, hn::Sub(hn::Mul(sine, o_cosine), hn::Mul(cosine, o_sine)));
    const Vec normal_cosine =
        hn::IfThenElse(in_cone, one, hn::Add(hn::Mul(cosine, o_cosine), hn::Mul(sine, o_sine)));

    const Vec view_sine = hn::Div(constant(light.radius), distance);
    const Vec view_cosine = sine_of(view_sine);
    const Vec best = hn::IfThenElse(
        hn::Ge(normal_cosine, view_cosine), one,
        hn::Add(hn::Mul(normal_cosine, view_cosine), hn::Mul(normal_sine, view_sine)));
    const Vec cos_theta_e = constant(static_cast<float>(light.cos_theta_e) * LightRecord::kSnorm);
    const Vec outside = hn::IfThenElseZero(hn::Gt(best, cos_theta_e), best);
    return hn::IfThenElse(hn::Gt(distance, constant(light.radius)), outside, one);
}

/// diffuse * received + mean_of_lobe(), where there is a lobe.
HWY_ATTR HWY_NOINLINE inline Vec with_lobes(const PointPacket& points, std::size_t i,
                                            const Ways& ways, Vec inverse, Vec spread,
                                            Vec received) {
    const Tag d;
    const Vec cosine =
        hn::Mul(ways.dot_with(points.lobe_x + i, points.lobe_y + i, points.lobe_z + i), inverse);
    const Vec alpha2 = hn::Load(d, points.alpha2 + i), peak = hn::Load(d, points.peak + i);
    const Vec angular_spread = hn::Mul(hn::Mul(spread, inverse), inverse);
    const Vec width = hn::Add(alpha2, hn::Mul(constant(0.25f), angular_spread));
    const Vec inverse_sum = hn::Div(
        constant(1.0f), hn::Add(width, hn::Mul(constant(0.5f), hn::Sub(constant(1.0f), cosine))));
    const Vec lobe =
        hn::Mul(hn::Mul(hn::Mul(hn::Mul(peak, alpha2), width), inverse_sum), inverse_sum);
    const Vec both = hn::Add(hn::Mul(hn::Load(d, points.diffuse + i), received), lobe);
    return hn::IfThenElse(hn::Gt(peak, constant(0.0f)), both, received);
}

HWY_ATTR inline Vec mean_distance2(const LightRecord& light, const Ways& ways) {
    const float spread = kSpread * light.radius * light.radius;
    return hn::Max(hn::Add(ways.distance2, constant(spread)), constant(kMinDistance2));
}

/// Where importance() may be above 0: neither below the receiver's horizon nor surely behind the
/// light. Most lights that are no use to a packet are found out here.
HWY_ATTR inline hn::Mask<Tag> may_matter(const LightRecord& light, const PointPacket& points,
                                         std::size_t i, const Ways& ways) {
    const Vec height =
        hn::Add(ways.dot_with(points.normal_x + i, points.normal_y + i, points.normal_z + i),
                hn::Load(Tag(), points.no_normal + i));
    const auto above = hn::Gt(hn::Add(height, constant(light.radius)), constant(0.0f));
    if (light.cos_theta_o != LightRecord::kFlat || light.two_sided != 0) return above;
    // emitted_height * inverse + kAxisRounding <= 0, without a root.
    constexpr float kSurely = 1.01f * kAxisRounding * kAxisRounding;
    const Vec sunk = ways.dot_with(axis_of(light));
    const auto behind = hn::Gt(hn::Mul(sunk, hn::Max(sunk, constant(0.0f))),
                               hn::Mul(constant(kSurely), mean_distance2(light, ways)));
    return hn::AndNot(behind, above);
}

/// importance().
HWY_ATTR inline Vec importances(const LightRecord& light, const PointPacket& points, std::size_t i,
                                const Ways& ways) {
    const Vec zero = constant(0.0f), one = constant(1.0f);
    const float spread = kSpread * light.radius * light.radius;
    const Vec inverse = hn::Div(one, hn::Sqrt(mean_distance2(light, ways)));

    const Vec height = ways.dot_with(points.normal_x + i, points.normal_y + i, points.normal_z + i);
    const Vec root = hn::Sqrt(hn::Add(hn::Mul(height, height), constant(kHeightSpread * spread)));
    const Vec mean_height = hn::Mul(constant(0.5f), hn::Add(height, root));
    // Both are 1 or 0: whether the normal is 0, and so is not.
    const Vec no_normal = hn::Load(Tag(), points.no_normal + i);
    Vec received = hn::IfThenElse(hn::Gt(no_normal, zero), one, hn::Mul(mean_height, inverse));
    if (points.has_lobes) {
        received = with_lobes(points, i, ways, inverse, constant(spread), received);
    }
    const auto below = hn::Le(hn::Add(hn::Add(height, no_normal), constant(light.radius)), zero);
    received = hn::IfThenZeroElse(below, received);

    Vec emitter;
    if (light.cos_theta_o == LightRecord::kFlat) {
        Vec emitted_height = hn::Neg(ways.dot_with(axis_of(light)));
        if (light.two_sided != 0) emitted_height = hn::Abs(emitted_height);
        emitter = hn::Min(hn::Add(hn::Mul(emitted_height, inverse), constant(kAxisRounding)), one);
    } else {
        emitter = emitter_bounds(light, ways);
    }
    const Vec product = hn::Mul(
        hn::Mul(hn::Mul(hn::Mul(constant(light.intensity), inverse), inverse), received), emitter);
    return hn::IfThenElseZero(hn::Gt(emitter, zero), product);
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

/// Adds a light to the reservoirs of those points that are within its sphere.
HWY_ATTR inline void weigh(const CullingTree& tree, const PointPacket& points, std::uint32_t record,
                           float sphere_radius, PacketChoice& choice) {
    const LightRecord& light = tree.record(record);
    const Vec limit2 = constant(sphere_radius * sphere_radius);
    const float inverse_limit = 1.0f / tree.ranges().limit(light.intensity);
    for (std::size_t i = 0; i < PointPacket::kSize; i += hn::Lanes(Tag())) {
        const Ways ways(points, i, light.center);
        const auto in_range =
            hn::And(hn::Le(ways.distance2, limit2), may_matter(light, points, i, ways));
        if (hn::AllFalse(Tag(), in_range)) continue;
        const Vec g = importances(light, points, i, ways);
        const auto accepted = hn::And(in_range, hn::Gt(g, constant(0.0f)));

        const Vec distance =
            hn::Max(hn::Sub(hn::Sqrt(ways.distance2), constant(light.radius)), constant(0.0f));
        const Vec inverse_prob =
            hn::Max(hn::Mul(hn::Mul(distance, distance), constant(inverse_limit)), constant(1.0f));
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
        const Vec top = hn::Add(hn::Add(height, hn::Load(Tag(), points.no_normal + i)), bounds);
        const auto above =
            hn::Ge(hn::Mul(top, hn::Abs(top)), hn::Mul(ways.distance2, constant(kHorizonRounding)));
        if (!hn::AllFalse(Tag(), hn::And(hn::Le(ways.distance2, limit), above))) return true;
    }
    return false;
}

/// Lights that are to be weighed once their records have come from memory.
struct Waiting {
    std::uint32_t records[SphereNode::kWidth];
    float radii[SphereNode::kWidth];
    std::uint32_t count = 0;
};

HWY_ATTR inline void weigh_all(const CullingTree& culling, const PointPacket& points,
                               Waiting& waiting, PacketChoice& choice) {
    for (std::uint32_t i = 0; i < waiting.count; ++i) {
        weigh(culling, points, waiting.records[i], waiting.radii[i], choice);
    }
    waiting.count = 0;
}

HWY_ATTR inline void select_packet(const CullingTree& culling, const PointPacket& points,
                                   PacketChoice& choice) {
    const SphereTree& tree = culling.tree();
    const float* radii = culling.radii(points.set);
    constexpr std::size_t kWidth = SphereNode::kWidth;
    std::uint32_t stack[TreeWalk::kStackSize];
    std::uint32_t stack_size = 0;
    if (!tree.empty()) stack[stack_size++] = 0;
    Waiting lists[2];
    std::uint32_t parity = 0;
    while (stack_size > 0) {
        const std::uint32_t n = stack[--stack_size];
        const SphereNode& node = tree.nodes[n];
        Waiting& found = lists[parity];
        parity ^= 1;
        const float* node_radii = radii + n * kWidth;
        assert(stack_size + kWidth <= TreeWalk::kStackSize);
        for (std::uint32_t bits = slots_near(node, node_radii, points); bits != 0;
             bits &= bits - 1) {
            const std::uint32_t slot =
                static_cast<std::uint32_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits));
            if (!concerns_any(points, node, slot, node_radii[slot])) continue;
            const std::uint32_t link = node.link[slot];
            if ((link & SphereNode::kLeaf) != 0) {
                const std::uint32_t record = link & ~SphereNode::kLeaf;
                hwy::Prefetch(&culling.record(record));
                found.records[found.count] = record;
                found.radii[found.count++] = node_radii[slot];
                continue;
            }
            walk::prefetch(tree.nodes[link], radii + link * kWidth);
            stack[stack_size++] = link;
        }
        weigh_all(culling, points, lists[parity], choice);
    }
    weigh_all(culling, points, lists[parity ^ 1], choice);
}

}  // namespace packet
}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
