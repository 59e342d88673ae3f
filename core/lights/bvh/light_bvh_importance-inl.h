// Included once per instruction set.
#if defined(LIGHTCULL_LIGHT_BVH_IMPORTANCE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_LIGHT_BVH_IMPORTANCE_INL
#undef LIGHTCULL_LIGHT_BVH_IMPORTANCE_INL
#else
#define LIGHTCULL_LIGHT_BVH_IMPORTANCE_INL
#endif

#include <hwy/highway.h>

#include "lights/bvh/cluster_importance-inl.h"
#include "lights/bvh/light_bvh_descend.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace bvh {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kWidth = LightBvhNode::kWidth;
using Tag = hn::CappedTag<float, kWidth>;
using Vec = hn::Vec<Tag>;

using cluster::dot;

/// An angle in [0, pi] by its sine and cosine.
struct AngleVec {
    Vec sine, cosine;
};

HWY_ATTR inline Vec other_of(Vec sine_or_cosine) {
    const auto one = hn::Set(Tag(), 1.0f);
    return hn::Sqrt(
        hn::Max(hn::Sub(one, hn::Mul(sine_or_cosine, sine_or_cosine)), hn::Zero(Tag())));
}

/// The angle max(0, a - b).
HWY_ATTR HWY_INLINE AngleVec subtract_clamped(AngleVec a, AngleVec b) {
    const auto none = hn::Ge(a.cosine, b.cosine);
    const auto sine = hn::Sub(hn::Mul(a.sine, b.cosine), hn::Mul(a.cosine, b.sine));
    const auto cosine = hn::Add(hn::Mul(a.cosine, b.cosine), hn::Mul(a.sine, b.sine));
    return {hn::IfThenZeroElse(none, sine), hn::IfThenElse(none, hn::Set(Tag(), 1.0f), cosine)};
}

/// The geometric importance of Conty Estevez & Kulla 2018, of the clusters under a node: intensity
/// by the squared distance to the middle of their bounds, by the largest cosines of emitter and
/// receiver that the angle filled by the bounds allows. An importance is 0 only where none of the
/// cluster can reach the receiver.
///
/// Here the bounds of a node are the sphere around its box (the eight corners of the box give 5 %
/// less variance for a third more time), a receiver has one side, and the distance is at least half
/// the radius (the mean variance is up to three times as large with all, no smaller with less).
HWY_ATTR HWY_INLINE void compute_importances(const BoundsNode& node, const Receiver& receiver,
                                             float* HWY_RESTRICT result) {
    const Tag d;
    const auto one = hn::Set(d, 1.0f);
    const auto nx = hn::Set(d, receiver.normal.x), ny = hn::Set(d, receiver.normal.y),
               nz = hn::Set(d, receiver.normal.z);
    for (std::size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
        const auto load = [&](const float* values) HWY_ATTR { return hn::Load(d, values + i); };
        const auto wx = hn::Sub(load(node.center[0]), hn::Set(d, receiver.position.x));
        const auto wy = hn::Sub(load(node.center[1]), hn::Set(d, receiver.position.y));
        const auto wz = hn::Sub(load(node.center[2]), hn::Set(d, receiver.position.z));
        const auto distance = hn::Sqrt(dot(wx, wy, wz, wx, wy, wz));
        // Bounds hold whatever the rounding of positions. A light without extent has none: at the
        // points about it, those that it cannot reach among them, it would outweigh all else.
        const auto bounds = load(node.radius);
        const auto has_bounds = hn::Gt(bounds, hn::Zero(d));
        const auto radius =
            hn::Add(bounds, hn::IfThenElseZero(has_bounds, hn::Set(d, receiver.rounding)));
        const auto least_distance = hn::Set(d, kMinDistance);
        const auto inverse = hn::Div(one, hn::Max(distance, least_distance));

        const auto half_sine = hn::Min(hn::Mul(radius, inverse), one);
        const AngleVec half_view{half_sine, other_of(half_sine)};
        const auto largest_cosine = [&](AngleVec angle) HWY_ATTR {
            return hn::Max(subtract_clamped(angle, half_view).cosine, hn::Zero(d));
        };

        const auto height = hn::Mul(dot(nx, ny, nz, wx, wy, wz), inverse);
        const auto seen = largest_cosine({other_of(height), height});
        const auto all_sides = hn::Gt(hn::Set(d, receiver.from_all_sides), hn::Zero(d));
        // Within the bounds nothing is known of either angle.
        const auto inside = hn::Ge(radius, distance);
        auto received = hn::IfThenElse(hn::Or(all_sides, inside), one, seen);
        if (receiver.has_lobe()) {
            // The mean in the bounds is taken: their largest value would outweigh all else wherever
            // the lobe is narrower than they are.
            const auto spread = hn::Mul(hn::Set(d, 0.4f), hn::Mul(half_sine, half_sine));
            const ReceiverLanes<Tag, Receiver> receivers{receiver};
            const cluster::Ways<Tag> ways(receivers, node.center, i);
            const auto glossy = cluster::with_lobe(d, receivers, ways, ways.height_over(receivers),
                                                   inverse, spread, received, nullptr);
            received = hn::IfThenElseZero(hn::Gt(received, hn::Zero(d)), glossy);
        }

        const auto cos_theta_e = load(node.cos_theta_e);
        const auto two_sided = hn::CopySign(one, cos_theta_e);  // -1 where all is two-sided
        const auto along = hn::Mul(
            dot(load(node.axis[0]), load(node.axis[1]), load(node.axis[2]), wx, wy, wz), inverse);
        const auto facing = hn::Max(hn::Neg(along), hn::Neg(hn::Mul(two_sided, along)));
        const AngleVec theta_o{load(node.sin_theta_o), load(node.cos_theta_o)};
        const auto cosine = largest_cosine(subtract_clamped({other_of(facing), facing}, theta_o));
        const auto emitted = hn::IfThenElseZero(hn::Ge(cosine, hn::Abs(cos_theta_e)), cosine);

        const auto factor = hn::IfThenElse(inside, received, hn::Mul(received, emitted));
        const auto inverse_clamped =
            hn::Div(one, hn::Max(distance, hn::Mul(hn::Set(d, 0.5f), radius)));
        const auto fall_off =
            hn::Mul(hn::Mul(load(node.intensity), inverse_clamped), inverse_clamped);
        const auto apart = hn::Gt(hn::Max(distance, radius), least_distance);
        hn::Store(hn::IfThenElseZero(apart, hn::Mul(fall_off, factor)), d, result + i);
    }
}

HWY_ATTR HWY_INLINE void compute_importances(const MeansNode& node, const Receiver& receiver,
                                             float* HWY_RESTRICT result) {
    const Tag d;
    const ReceiverLanes<Tag, Receiver> receivers{receiver};
    for (std::size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
        const cluster::Ways<Tag> ways(receivers, node.center, i);
        const auto height = ways.height_over(receivers);
        const auto reached = cluster::may_reach(d, node, i, receivers, ways, height);
        const auto mean = cluster::mean_importance(d, node, i, receivers, ways, height);
        hn::Store(hn::IfThenElseZero(reached, mean), d, result + i);
    }
}

}  // namespace bvh
}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
