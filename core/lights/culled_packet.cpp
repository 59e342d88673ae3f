#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lights/culled_packet.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h, which includes this file once per instruction set.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cassert>

#include "lights/culled_packet.h"
#include "lights/reservoir.h"
#include "lights/sphere_tree_traverse.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
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
    Vec x, y, z, distance2, distance;

    HWY_ATTR Ways(const PointPacket& points, std::size_t i, float3 center)
        : x(hn::Sub(constant(center.x), hn::Load(Tag(), points.x + i))),
          y(hn::Sub(constant(center.y), hn::Load(Tag(), points.y + i))),
          z(hn::Sub(constant(center.z), hn::Load(Tag(), points.z + i))),
          distance2(dot(x, y, z, x, y, z)),
          distance(hn::Sqrt(distance2)) {}
    HWY_ATTR Vec dot_with(float3 v) const {
        return dot(constant(v.x), constant(v.y), constant(v.z), x, y, z);
    }
};

/// emitter_bound(), and 1 within the sphere.
HWY_ATTR HWY_NOINLINE Vec emitter_bounds(const LightRecord& light, const Ways& ways) {
    const Vec zero = constant(0.0f), one = constant(1.0f);
    const Vec inverse =
        hn::IfThenElseZero(hn::Gt(ways.distance, zero), hn::Div(one, ways.distance));
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

    const Vec view_sine = hn::Div(constant(light.radius), ways.distance);
    const Vec view_cosine = sine_of(view_sine);
    const Vec best = hn::IfThenElse(
        hn::Ge(normal_cosine, view_cosine), one,
        hn::Add(hn::Mul(normal_cosine, view_cosine), hn::Mul(normal_sine, view_sine)));
    const Vec cos_theta_e = constant(static_cast<float>(light.cos_theta_e) * LightRecord::kSnorm);
    const Vec outside = hn::IfThenElseZero(hn::Gt(best, cos_theta_e), best);
    return hn::IfThenElse(hn::Gt(ways.distance, constant(light.radius)), outside, one);
}

/// importance().
HWY_ATTR inline Vec importances(const LightRecord& light, const PointPacket& points, std::size_t i,
                                const Ways& ways) {
    const Vec zero = constant(0.0f), one = constant(1.0f);
    const float spread = kSpread * light.radius * light.radius;
    const Vec mean_distance2 =
        hn::Max(hn::Add(ways.distance2, constant(spread)), constant(kMinDistance2));
    const Vec inverse = hn::Div(one, hn::Sqrt(mean_distance2));

    const Vec nx = hn::Load(Tag(), points.normal_x + i), ny = hn::Load(Tag(), points.normal_y + i),
              nz = hn::Load(Tag(), points.normal_z + i);
    const auto no_normal = hn::And(hn::Eq(nx, zero), hn::And(hn::Eq(ny, zero), hn::Eq(nz, zero)));
    const Vec received_height = dot(nx, ny, nz, ways.x, ways.y, ways.z);
    const Vec root = hn::Sqrt(
        hn::Add(hn::Mul(received_height, received_height), constant(kHeightSpread * spread)));
    const Vec mean_height = hn::Mul(constant(0.5f), hn::Add(received_height, root));
    const Vec above =
        hn::IfThenElseZero(hn::Gt(hn::Add(received_height, constant(light.radius)), zero),
                           hn::Mul(mean_height, inverse));
    const Vec receiver = hn::IfThenElse(no_normal, one, above);

    Vec emitter;
    if (light.cos_theta_o == LightRecord::kFlat) {
        Vec height = hn::Neg(ways.dot_with(axis_of(light)));
        if (light.two_sided != 0) height = hn::Abs(height);
        emitter = hn::Min(hn::Add(hn::Mul(height, inverse), constant(kAxisRounding)), one);
    } else {
        emitter = emitter_bounds(light, ways);
    }
    const Vec product = hn::Mul(
        hn::Mul(hn::Mul(hn::Mul(constant(light.intensity), inverse), inverse), receiver), emitter);
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

HWY_ATTR inline void weigh(const CullingTree& tree, const PointPacket& points, std::uint32_t record,
                           PacketChoice& choice) {
    const LightRecord& light = tree.record(record);
    const RandomRanges& ranges = tree.ranges();
    const Vec xi = constant(ranges.xi(record, points.set));
    const Vec limit = constant(ranges.limit(light.intensity));
    for (std::size_t i = 0; i < PointPacket::kSize; i += hn::Lanes(Tag())) {
        const Ways ways(points, i, light.center);
        const Vec distance =
            hn::Max(hn::Sub(ways.distance, constant(light.radius)), constant(0.0f));
        const Vec distance2 = hn::Mul(distance, distance);
        const auto in_range = hn::Le(hn::Mul(distance2, xi), limit);
        if (hn::AllFalse(Tag(), in_range)) continue;
        const Vec g = importances(light, points, i, ways);
        const auto accepted = hn::And(in_range, hn::Gt(g, constant(0.0f)));

        const Vec prob =
            hn::IfThenElse(hn::Le(distance2, limit), constant(1.0f), hn::Div(limit, distance2));
        const Vec weight = hn::IfThenElseZero(accepted, hn::Div(g, prob));
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

/// Whether any of the points is within the sphere of a slot.
HWY_ATTR inline bool any_inside(const PointPacket& points, float3 center, float radius) {
    const Vec limit = constant(radius * radius);
    for (std::size_t i = 0; i < PointPacket::kSize; i += hn::Lanes(Tag())) {
        const Vec dx = hn::Sub(constant(center.x), hn::Load(Tag(), points.x + i));
        const Vec dy = hn::Sub(constant(center.y), hn::Load(Tag(), points.y + i));
        const Vec dz = hn::Sub(constant(center.z), hn::Load(Tag(), points.z + i));
        if (!hn::AllFalse(Tag(), hn::Le(dot(dx, dy, dz, dx, dy, dz), limit))) return true;
    }
    return false;
}

HWY_ATTR void select_packet_here(const CullingTree& culling, const PointPacket& points,
                                 PacketChoice& choice) {
    const SphereTree& tree = culling.tree();
    const float* radii = culling.radii(points.set);
    constexpr std::size_t kWidth = SphereNode::kWidth;
    TreeWalk walk;
    if (!tree.empty()) walk.stack[walk.stack_size++] = 0;
    while (walk.stack_size > 0) {
        const std::uint32_t n = walk.stack[--walk.stack_size];
        const SphereNode& node = tree.nodes[n];
        const float* node_radii = radii + n * kWidth;
        for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
            const std::uint32_t link = node.link[slot];
            if (link == SphereNode::kEmpty) break;  // slots are filled from the first on
            if (!any_inside(points, node.center(slot), node_radii[slot])) continue;
            if ((link & SphereNode::kLeaf) != 0) {
                weigh(culling, points, link & ~SphereNode::kLeaf, choice);
                continue;
            }
            assert(walk.stack_size < TreeWalk::kStackSize);
            hwy::Prefetch(tree.nodes[link].x);
            hwy::Prefetch(tree.nodes[link].z);
            hwy::Prefetch(radii + link * kWidth);
            walk.stack[walk.stack_size++] = link;
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lightcull {

HWY_EXPORT(select_packet_here);

void select_packet(const CullingTree& tree, const PointPacket& points,
                   PacketChoice& choice) noexcept {
    choice = {};
    HWY_DYNAMIC_DISPATCH(select_packet_here)(tree, points, choice);
}

}  // namespace lightcull
#endif
