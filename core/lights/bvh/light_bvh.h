#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/light/light_record.h"

namespace lightcull {

/// A node holds eight clusters of lights, in the units of a LightTable, by what their importance
/// needs (light_bvh_importance-inl.h says how): one array per quantity, so that it is computed for
/// all of them at once. A cluster is a node or one light.
struct LightBvhNode {
    static constexpr int kWidth = 8;
    static constexpr std::uint32_t kLight = 0x80000000u;
    static constexpr std::uint32_t kEmpty = 0xffffffffu;
};

/// A node for ClusterImportance::kBounds.
struct alignas(64) BoundsNode : LightBvhNode {
    float center[3][kWidth];      ///< centre of a sphere that holds all of the cluster
    float radius[kWidth];         ///< radius of that sphere
    float intensity[kWidth];      ///< sum of intensities; 0: empty
    float axis[3][kWidth];        ///< axis of the cone that holds all normals
    float cos_theta_o[kWidth];    ///< cosine of that cone's half-angle
    float sin_theta_o[kWidth];    ///< sine of that cone's half-angle
    float cos_theta_e[kWidth];    ///< cosine of the largest angle to a normal. The sign bit is set
                                  ///< where all of the cluster is two-sided
    std::uint32_t child[kWidth];  ///< index of a node, or kLight | the caller's index of a light,
                                  ///< or kEmpty
};
static_assert(sizeof(BoundsNode) == 384 && alignof(BoundsNode) == 64);

/// The quantities that the importance by means needs of clusters, kCount of them.
template <std::size_t kCount>
struct ClusterMeans {
    float center[3][kCount];  ///< mean position, weighted by intensity
    float radius[kCount];     ///< radius of a sphere around center that holds all of the cluster
    float spread[kCount];     ///< variance of position as the importance takes it; negative: a
                              ///< flat light, emission does not depend on it
    float intensity[kCount];  ///< sum of intensities; 0: empty
    float axis[3][kCount];    ///< axis of the cone into which the cluster emits
    float apex[kCount];       ///< distance behind center at which a cone begins that holds the
                              ///< cones of all points of the sphere
    float cosine[kCount];     ///< cosine of the cone's half-angle, times its own absolute
                              ///< value; -2: the cluster emits everywhere
    float mean_normal[3][kCount];  ///< mean normal, weighted by intensity; short where normals
                                   ///< differ
    float diffuse[kCount];         ///< emission of the cluster whatever the direction: the square
                                   ///< of twice that share of its intensity. The sign bit is set
                                   ///< where all of it is two-sided
    std::uint32_t child[kCount];   ///< the same numbers as in BoundsNode

    /// Takes over one of the clusters of another.
    template <std::size_t kOthers>
    void set(std::size_t i, const ClusterMeans<kOthers>& other, std::size_t j) noexcept {
        for (std::size_t k = 0; k < 3; ++k) {
            center[k][i] = other.center[k][j];
            axis[k][i] = other.axis[k][j];
            mean_normal[k][i] = other.mean_normal[k][j];
        }
        radius[i] = other.radius[j];
        spread[i] = other.spread[j];
        intensity[i] = other.intensity[j];
        apex[i] = other.apex[j];
        cosine[i] = other.cosine[j];
        diffuse[i] = other.diffuse[j];
        child[i] = other.child[j];
    }
};

/// A node for ClusterImportance::kMeans.
struct alignas(64) MeansNode : LightBvhNode, ClusterMeans<LightBvhNode::kWidth> {};
static_assert(sizeof(MeansNode) == 512 && alignof(MeansNode) == 64);

/// The number of one of a node's eight children: 8 * node + place.
using LightBvhSlot = std::uint32_t;

/// A light BVH. Node: BoundsNode or MeansNode.
template <typename Node>
struct LightBvh {
    /// The length that no path from the root to a light exceeds.
    static constexpr int kMaxDepth = 72;
    static constexpr LightBvhSlot kNoSlot = 0xffffffffu;

    std::vector<Node> nodes;            ///< node 0 is the root; none where no light is lit
    std::vector<LightBvhSlot> parents;  ///< slot that holds a node, by node
    std::vector<LightBvhSlot> slots;    ///< slot of a light, by the caller's light; kNoSlot if not
                                        ///< lit
};

/// Builds over the lit lights of a table; the tree is the same for both kinds of node. Runs in the
/// caller's TBB arena; the result does not depend on it.
template <typename Node>
LightBvh<Node> build_light_bvh(const LightTable& table);

/// Fits the nodes to lights that have changed; the topology stays. Lights that were not lit when
/// the tree was built must not be lit now. Runs in the caller's TBB arena; the result does not
/// depend on it.
template <typename Node>
void refit_light_bvh(LightBvh<Node>& bvh, const LightTable& table);

/// True if all lit lights have a place in the tree, so that it can be refitted.
template <typename Node>
bool holds_all_lit(const LightBvh<Node>& bvh, const LightTable& table) noexcept {
    for (const std::uint32_t light : table.lit) {
        if (bvh.slots[light] == LightBvh<Node>::kNoSlot) return false;
    }
    return true;
}

/// The looseness of a tree, whatever the size of all of it: the sum over inner slots of intensity
/// by squared radius, relative to those of the root. It is 0 without inner slots. Far lights do not
/// count.
template <typename Node>
double looseness(const LightBvh<Node>& bvh) noexcept;

/// The value of LightUpdate::growth for the looseness of a tree now, and when it was built.
inline float growth(double now, double built) noexcept {
    return built > 0.0 ? static_cast<float>(now / built) : 1.0f;
}

extern template LightBvh<BoundsNode> build_light_bvh(const LightTable& table);
extern template LightBvh<MeansNode> build_light_bvh(const LightTable& table);

}  // namespace lightcull
