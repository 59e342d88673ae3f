#pragma once

#include <lightcull/export.h>
#include <lightcull/float3.h>
#include <lightcull/light.h>
#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightcull {

/// A cluster of lights as the sampler light_bvh:importance=means knows it, in the units of a
/// LightBvhTable: sixteen numbers of 32 bits. A cluster is a node or one light.
struct LightBvhCluster {
    float3 center;       ///< mean position, weighted by intensity
    float radius;        ///< radius of a sphere around center that holds all of the cluster
    float spread;        ///< variance of position as the importance takes it; negative: a flat
                         ///< light, emission does not depend on it
    float intensity;     ///< sum of intensities; 0: empty
    float3 axis;         ///< axis of the cone into which the cluster emits
    float apex;          ///< distance behind center at which a cone begins that holds the cones of
                         ///< all points of the sphere
    float cosine;        ///< cosine of the cone's half-angle, times its own absolute value; -2: the
                         ///< cluster emits everywhere
    float3 mean_normal;  ///< mean normal, weighted by intensity; short where normals differ
    float diffuse;       ///< emission of the cluster whatever the direction: the square of twice
                         ///< that share of its intensity. The sign bit is set where all of it is
                         ///< two-sided
    std::uint32_t child;  ///< index of a node, or LightBvhTable::kLight | the caller's index of a
                          ///< light, or LightBvhTable::kEmpty
};
static_assert(sizeof(LightBvhCluster) == 64 && alignof(LightBvhCluster) == 4);

/// The tree of the sampler light_bvh:importance=means, for a host that walks it itself, as in a
/// kernel of its own. A walk begins at node 0. At each node it computes the importances of its
/// eight clusters at the point and goes to one of them in proportion, until it is at a light; the
/// probability of a light is the product over the nodes on the way to it.
struct LightBvhTable {
    static constexpr std::uint32_t kWidth = 8;  ///< clusters of a node
    static constexpr std::uint32_t kLight = 0x80000000u, kEmpty = 0xffffffffu, kNone = 0xffffffffu;

    float3 origin{0, 0, 0};                 ///< origin of the table's units, metres
    float inv_scale = 1.0f;                 ///< units of the table, 1 / metres: a position x is
                                            ///< (x - origin) * inv_scale
    std::vector<LightBvhCluster> clusters;  ///< clusters of node i are those from kWidth * i on;
                                            ///< none where no light is lit
    std::vector<std::uint32_t> parents;     ///< cluster that a node is, by node; kNone for node 0
    std::vector<std::uint32_t> leaves;      ///< cluster that a light is, by the caller's light;
                                            ///< kNone for one that is not lit
};

/// The tree over `lights`. Runs in the caller's TBB arena; the result does not depend on it. Throws
/// Error as make_sampler() does.
LIGHTCULL_EXPORT LightBvhTable make_light_bvh_table(Span<const Light> lights);

}  // namespace lightcull
