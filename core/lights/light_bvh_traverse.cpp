#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lights/light_bvh_traverse.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h, which includes this file once per instruction set.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>

#include "lights/light_bvh_traverse.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kWidth = LightBvhNode::kWidth;
using Tag = hn::CappedTag<float, kWidth>;
using Vec = hn::Vec<Tag>;

HWY_ATTR inline Vec dot(Vec ax, Vec ay, Vec az, Vec bx, Vec by, Vec bz) {
    return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

/// c + sqrt(c^2 + q): twice the mean of max(0, c) where c spreads by about sqrt(q).
HWY_ATTR inline Vec softened(Vec c, Vec q) {
    return hn::Add(c, hn::Sqrt(hn::Add(hn::Mul(c, c), q)));
}

/// What the clusters under a node are estimated to give a point, relative to each other: the
/// geometric importance of Conty Estevez & Kulla 2018, intensity times the cosines of
/// emitter and receiver by the squared distance. They bound both cosines by what the bounding
/// sphere and the cone allow, which favours near clusters wherever they face; here the cosines are
/// means over the cluster. With w the way to the mean position, q its spread and m the mean normal
/// (1 long where all lights face one way, 0 where they face every way), the squared distance is
/// w^2 + q, and a mean is a hyperbola in n.w for the receiver's normal n, and in -m.w, where the
/// diffuse part of the emission adds to its root. The bounds stay on as gates: an importance is 0
/// only where none of the cluster can reach the point.
///
/// Measured on seven scenes, the variance of the estimate is 2 to 16 times smaller than by bounds.
HWY_ATTR HWY_INLINE void importances_here(const LightBvhNode& node, const LightBvhPoint& point,
                                          float* HWY_RESTRICT result) {
    const Tag d;
    const auto nx = hn::Set(d, point.normal.x), ny = hn::Set(d, point.normal.y),
               nz = hn::Set(d, point.normal.z);
    for (std::size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
        const auto load = [&](const float* values) HWY_ATTR { return hn::Load(d, values + i); };
        const auto wx = hn::Sub(load(node.center[0]), hn::Set(d, point.position.x));
        const auto wy = hn::Sub(load(node.center[1]), hn::Set(d, point.position.y));
        const auto wz = hn::Sub(load(node.center[2]), hn::Set(d, point.position.z));
        const auto distance2 = dot(wx, wy, wz, wx, wy, wz);
        const auto height = dot(nx, ny, nz, wx, wy, wz);
        const auto diffuse = load(node.diffuse);
        const auto two_sided = hn::CopySign(hn::Set(d, 1.0f), diffuse);  // -1: yes
        const auto one_or_both = [&](Vec c) HWY_ATTR {
            return hn::Max(hn::Neg(c), hn::Neg(hn::Mul(two_sided, c)));
        };
        const auto facing = one_or_both(dot(load(node.mean_normal[0]), load(node.mean_normal[1]),
                                            load(node.mean_normal[2]), wx, wy, wz));
        const auto along = one_or_both(
            dot(load(node.axis[0]), load(node.axis[1]), load(node.axis[2]), wx, wy, wz));

        const auto signed_spread = load(node.spread);
        const auto spread = hn::Abs(signed_spread);
        const auto mean_distance2 = hn::Add(distance2, spread);
        const auto received = softened(
            height, hn::Add(spread, hn::Mul(hn::Set(d, point.from_all_sides), mean_distance2)));
        const auto across_emitter = hn::Max(signed_spread, hn::Zero(d));
        const auto emitted =
            softened(facing, hn::Add(across_emitter, hn::Mul(hn::Abs(diffuse), mean_distance2)));
        const auto inverse = hn::Div(hn::Set(d, 1.0f), mean_distance2);
        // In this order nothing gets as large or small as a fourth power of the distance.
        const auto mean = hn::Mul(hn::Mul(load(node.intensity), hn::Mul(received, inverse)),
                                  hn::Mul(emitted, inverse));

        // Of the way from the cone's apex: its part along the axis, and its square.
        const auto apex = load(node.apex);
        const auto from_apex = hn::Add(along, apex);
        const auto from_apex2 = hn::Add(distance2, hn::Mul(apex, hn::Add(along, from_apex)));
        const auto above = hn::Gt(hn::Add(height, load(node.radius)), hn::Set(d, point.horizon));
        const auto inside =
            hn::Ge(hn::Mul(from_apex, hn::Abs(from_apex)), hn::Mul(load(node.cosine), from_apex2));
        hn::Store(hn::IfThenElseZero(hn::And(above, inside), mean), d, result + i);
    }
}

/// How the choice falls among a node's children.
struct Shares {
    LightBvhImportances importances;
    double sums[kWidth];  ///< of the importances up to and with each

    HWY_ATTR Shares(const LightBvhNode& node, const LightBvhPoint& point) {
        importances_here(node, point, importances.of);
        // In double precision, where each importance above 0 raises the sum.
        double sum = 0.0;
        for (std::size_t i = 0; i < kWidth; ++i) {
            sum += static_cast<double>(importances.of[i]);
            sums[i] = sum;
        }
    }
    double total() const { return sums[kWidth - 1]; }
    double prob(std::size_t i) const { return static_cast<double>(importances.of[i]) / total(); }
    /// The child that `place` falls on; it becomes the place within that child's share. No child of
    /// importance 0 is chosen, and total() must not be 0.
    HWY_ATTR std::size_t choose(double& place) const {
        const double target = place * total();
        std::size_t chosen = 0;
        for (std::size_t i = 0; i + 1 < kWidth; ++i) chosen += sums[i] <= target ? 1 : 0;
        const double before = chosen > 0 ? sums[chosen - 1] : 0.0;
        constexpr double kBelowOne = 1.0 - 0x1p-53;
        place =
            std::min((target - before) / static_cast<double>(importances.of[chosen]), kBelowOne);
        return chosen;
    }
};

HWY_ATTR inline void prefetch(const LightBvhNode& node) {
    constexpr std::size_t kLine = 64;
    const auto* bytes = reinterpret_cast<const char*>(&node);
    for (std::size_t at = 0; at < sizeof node; at += kLine) hwy::Prefetch(bytes + at);
}

/// One level down. False at the end of the way.
HWY_ATTR inline bool step(const LightBvh& bvh, LightBvhDescent& descent) {
    const LightBvhNode& node = bvh.nodes[descent.child];
    const Shares shares(node, descent.point);
    if (!(shares.total() > 0.0)) {
        descent.prob = 0.0;
        return false;
    }
    const std::size_t chosen = shares.choose(descent.place);
    descent.prob *= shares.prob(chosen);
    descent.child = node.child[chosen];
    if ((descent.child & LightBvhNode::kLight) != 0) return false;
    prefetch(bvh.nodes[descent.child]);
    return true;
}

HWY_ATTR void descend_here(const LightBvh& bvh, Span<LightBvhDescent> descents) {
    LightBvhDescent* under_way[kMaxDescents];
    std::size_t count = descents.size();
    for (std::size_t i = 0; i < count; ++i) under_way[i] = &descents[i];
    while (count > 0) {
        std::size_t left = 0;
        for (std::size_t i = 0; i < count; ++i) {
            under_way[left] = under_way[i];
            left += step(bvh, *under_way[left]) ? 1 : 0;
        }
        count = left;
    }
}

HWY_ATTR double prob_of_light_here(const LightBvh& bvh, const LightBvhPoint& point,
                                   std::uint32_t light) {
    LightBvhSlot path[LightBvh::kMaxDepth];
    std::size_t depth = 0;
    for (LightBvhSlot slot = bvh.slots[light]; slot != LightBvh::kNoSlot;
         slot = bvh.parents[slot / kWidth]) {
        path[depth++] = slot;
    }
    if (depth == 0) return 0.0;
    double prob = 1.0;
    while (depth-- > 0) {
        const Shares shares(bvh.nodes[path[depth] / kWidth], point);
        if (!(shares.total() > 0.0)) return 0.0;
        prob *= shares.prob(path[depth] % kWidth);
    }
    return prob;
}

}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lightcull {

HWY_EXPORT(importances_here);
HWY_EXPORT(descend_here);
HWY_EXPORT(prob_of_light_here);

LightBvhImportances importances(const LightBvhNode& node, const LightBvhPoint& point) noexcept {
    LightBvhImportances result;
    HWY_DYNAMIC_DISPATCH(importances_here)(node, point, result.of);
    return result;
}

void descend(const LightBvh& bvh, Span<LightBvhDescent> descents) noexcept {
    HWY_DYNAMIC_DISPATCH(descend_here)(bvh, descents);
}

double prob_of_light(const LightBvh& bvh, const LightBvhPoint& point,
                     std::uint32_t light) noexcept {
    return HWY_DYNAMIC_DISPATCH(prob_of_light_here)(bvh, point, light);
}

}  // namespace lightcull
#endif
