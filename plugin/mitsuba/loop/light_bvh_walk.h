#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

// The way down a light BVH (lightcull/light_bvh_table.h), step by step, for a number or for Dr.Jit
// arrays of them: the twin of the importance and the descent in core/lights/bvh. Functions of
// numbers stand here, those of arrays are Dr.Jit's.

namespace mitsuba::culling::walk {

inline float maximum(float a, float b) {
    return std::max(a, b);
}
inline double minimum(double a, double b) {
    return std::min(a, b);
}
inline float fmadd(float a, float b, float c) {
    return a * b + c;
}
inline float mulsign(float a, float b) {
    return std::signbit(b) ? -a : a;
}
template <typename T>
T select(bool condition, T a, T b) {
    return condition ? a : b;
}
using std::abs;
using std::sqrt;

template <typename Float>
struct Vec3 {
    Float x, y, z;
};

template <typename Float>
Vec3<Float> operator-(const Vec3<Float>& a, const Vec3<Float>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename Float>
Vec3<Float> operator*(const Vec3<Float>& a, const Float& s) {
    return {a.x * s, a.y * s, a.z * s};
}
template <typename Float>
Float dot(const Vec3<Float>& a, const Vec3<Float>& b) {
    return fmadd(a.z, b.z, fmadd(a.y, b.y, a.x * b.x));
}

/// The fields of lightcull::LightBvhCluster, all but its child.
template <typename Float>
struct Cluster {
    Vec3<Float> center;
    Float radius, spread, intensity;
    Vec3<Float> axis;
    Float apex, cosine;
    Vec3<Float> mean_normal;
    Float diffuse;
};

/// A point to be lit, in the units of the tree.
template <typename Float>
struct Point {
    Vec3<Float> position;
    Vec3<Float> normal;     ///< 0: light from all sides counts alike
    Float from_all_sides;   ///< flag: 4 if the normal is 0, else 0
    Float horizon;          ///< height below which nothing can reach the point
    bool has_lobe = false;  ///< false: the rest is not used, at any of the points
    Float diffuse{};
    Vec3<Float> axis{};
    Float alpha2{}, peak{};
};

template <typename Float>
Point<Float> matte_point(const Vec3<Float>& position, const Vec3<Float>& normal) {
    constexpr float kRounding = 1e-6f;
    const auto volume = dot(normal, normal) == 0.0f;
    const Float rounding = kRounding * (1.0f + abs(position.x) + abs(position.y) + abs(position.z));
    return {position, normal, select(volume, Float(4.0f), Float(0.0f)),
            select(volume, Float(-1e30f), -rounding)};
}

/// The dot product with the sign changed; for two-sided clusters the larger of both signs.
template <typename Float>
Float against(const Vec3<Float>& vector, const Vec3<Float>& way, const Float& two_sided) {
    const Float c = dot(vector, way);
    return maximum(-c, -(two_sided * c));
}

/// The sum c + sqrt(c^2 + q), negative where q is 0 and c^2 underflows.
template <typename Float>
Float softened(const Float& c, const Float& q) {
    return c + sqrt(fmadd(c, c, q));
}

/// The sum of diffuse * received and the glossy lobe, as with_lobe() of core/lights/bvh.
template <typename Float>
Float with_lobe(const Point<Float>& point, const Vec3<Float>& way, const Float& height,
                const Float& inverse_distance, const Float& angular_spread, const Float& received) {
    constexpr float kLeastTwiceHalf2 = 1e-20f;
    const Vec3<Float> from_axis = way * inverse_distance - point.axis;
    const Float above = dot(point.normal, from_axis);
    const Vec3<Float> across = from_axis - point.normal * above;
    const Float across2 = dot(across, across);
    const Float along = fmadd(height, inverse_distance, dot(point.normal, point.axis));
    const Float twice_half2 =
        fmadd(along, along, point.from_all_sides) + maximum(across2, Float(kLeastTwiceHalf2));
    const Float inverse_half2 = 1.0f / twice_half2;
    const Float width =
        fmadd(fmadd(Float(0.5f), inverse_half2, Float(0.125f)), angular_spread, point.alpha2);
    const Float inverse = 1.0f / fmadd(1.0f - point.alpha2, across2 * inverse_half2, width);
    return fmadd(point.diffuse, received, point.peak * point.alpha2 * width * inverse * inverse);
}

/// The importance of a cluster, 0 where none of it reaches the point.
template <typename Float>
Float importance(const Cluster<Float>& cluster, const Point<Float>& point) {
    constexpr float kMinDistance2 = 1e-30f;
    const Vec3<Float> way = cluster.center - point.position;
    const Float distance2 = dot(way, way), height = dot(point.normal, way);
    const Float two_sided = mulsign(Float(1.0f), cluster.diffuse);

    const Float along = against(cluster.axis, way, two_sided);
    const Float from_apex = along + cluster.apex;
    const Float from_apex2 = fmadd(cluster.apex, along + from_apex, distance2);
    const auto reached = from_apex * abs(from_apex) >= cluster.cosine * from_apex2 &&
                         height + cluster.radius > point.horizon;

    const Float spread = abs(cluster.spread);
    const Float mean_distance2 = distance2 + spread;
    Float received = softened(height, fmadd(point.from_all_sides, mean_distance2, spread));
    if (point.has_lobe) {
        const Float root = sqrt(mean_distance2), inverse_root = 1.0f / root;
        const Float both =
            with_lobe(point, way, height, inverse_root, spread * inverse_root * inverse_root,
                      0.5f * received * inverse_root);
        received = select(point.peak > 0.0f, (root + root) * both, received);
    }
    const Float facing = against(cluster.mean_normal, way, two_sided);
    const Float emitted = softened(
        facing, fmadd(abs(cluster.diffuse), mean_distance2, maximum(cluster.spread, Float(0.0f))));
    const Float inverse = 1.0f / mean_distance2;
    const Float g = cluster.intensity * (received * inverse) * (emitted * inverse);
    return select(reached && mean_distance2 > kMinDistance2, maximum(g, Float(0.0f)), Float(0.0f));
}

/// A walk from the root to a light.
template <typename Types>
struct Descent {
    typename Types::UInt32 child;  ///< LightBvhCluster::child of where it is
    typename Types::Double place;  ///< place in the share of `child` where the choice falls, [0, 1)
    typename Types::Float prob;    ///< probability of `child`; 0: nothing there reaches the point
};

/// The importances of a node's clusters. Table: gives width(), how many clusters of a node are to
/// be looked at, and cluster(node, i, active).
template <typename Types>
struct Importances {
    static constexpr std::uint32_t kWidth = 8;
    using Float = typename Types::Float;

    template <typename Table>
    Importances(const Table& table, const Point<Float>& point, const typename Types::UInt32& node,
                const typename Types::Mask& active)
        : count(table.width()) {
        for (std::uint32_t i = 0; i < count; ++i) {
            of[i] = importance(table.cluster(node, i, active), point);
        }
    }

    std::uint32_t count;
    Float of[kWidth];
};

/// Takes a descent one level down.
template <typename Types, typename Table>
void step_down(const Table& table, const Point<typename Types::Float>& point,
               const typename Types::Mask& active, Descent<Types>& descent) {
    using Float = typename Types::Float;
    using Double = typename Types::Double;
    using UInt32 = typename Types::UInt32;
    const Importances<Types> importances(table, point, descent.child, active);
    // The sums are in double precision, where each importance above 0 raises the sum.
    Double total(0.0), sums[Importances<Types>::kWidth];  // sums: of those before each
    for (std::uint32_t i = 0; i < importances.count; ++i) {
        sums[i] = total;
        total += Double(importances.of[i]);
    }
    const Double target = descent.place * total;
    UInt32 chosen(0);
    Double before(0.0);
    Float share = importances.of[0];
    for (std::uint32_t i = 1; i < importances.count; ++i) {
        const auto beyond = sums[i] <= target;
        chosen = select(beyond, UInt32(i), chosen);
        before = select(beyond, sums[i], before);
        share = select(beyond, importances.of[i], share);
    }
    constexpr double kBelowOne = 1.0 - 0x1p-53;
    const auto there = total > 0.0;
    descent.place = minimum((target - before) / Double(share), Double(kBelowOne));
    descent.prob = select(there, descent.prob * (share / Float(total)), Float(0.0f));
    descent.child = table.child(descent.child, chosen, active && there);
}

/// The probability that a step down from the node of `cluster` goes to it; 0 if nothing there
/// reaches the point.
template <typename Types, typename Table>
typename Types::Float prob_of_step(const Table& table, const Point<typename Types::Float>& point,
                                   const typename Types::UInt32& cluster,
                                   const typename Types::Mask& active) {
    using Float = typename Types::Float;
    using UInt32 = typename Types::UInt32;
    constexpr std::uint32_t kWidth = Importances<Types>::kWidth;
    const UInt32 node = cluster / kWidth, place = cluster - node * kWidth;
    const Importances<Types> importances(table, point, node, active);
    Float share(0.0f), total(0.0f);
    for (std::uint32_t i = 0; i < importances.count; ++i) {
        share = select(place == i, importances.of[i], share);
        total += importances.of[i];
    }
    return select(total > 0.0f, share / total, Float(0.0f));
}

}  // namespace mitsuba::culling::walk
