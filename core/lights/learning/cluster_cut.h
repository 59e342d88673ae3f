#pragma once

#include <cstddef>
#include <cstdint>

#include "lights/bvh/light_bvh.h"

namespace lightcull {

/// A cut through a light BVH: clusters that together hold each lit light once, in the order of the
/// tree's leaves, each with what a place sees of it. The places after the last cluster are empty
/// ones, of importance 0.
struct alignas(64) ClusterCut : ClusterMeans<128> {
    static constexpr std::uint32_t kMaxSize = 128;

    float visible[kMaxSize];  ///< factor of what is seen of a cluster, (0, 1]; 1: not tried
    float scale[kMaxSize];    ///< factor of a cluster's importance, above 0: `visible`
                              ///< by what its parts together give the place, relative
                              ///< to what it is taken to give as a whole
    std::uint32_t first_leaf[kMaxSize];  ///< first leaf of a cluster (LeafOrder), ascending
    LightBvhSlot slot[kMaxSize];         ///< slot of the tree that holds a cluster
    std::uint32_t size = 0;              ///< number of clusters

    ClusterCut() noexcept { clear(); }
    void clear() noexcept;

    /// The place of the cluster that holds a leaf. The cut must not be empty.
    std::uint32_t place_of_leaf(std::uint32_t leaf) const noexcept;
};

/// The weights of the clusters of a cut at a receiver: importance by `scale`; and their sums. Where
/// a receiver has a lobe, clusters too wide to tell what of them lies in it are replaced by the
/// children of their nodes, by `visible`.
struct alignas(64) CutWeights {
    static constexpr std::size_t kStride = 16;
    static constexpr std::uint32_t kWidth = LightBvhNode::kWidth;
    static constexpr std::uint32_t kMaxOpened = 16;
    static constexpr std::uint32_t kMaxSize = ClusterCut::kMaxSize + kMaxOpened * kWidth;

    float of[kMaxSize];  ///< weights: first by place in the cut, from first_opened on by place in
                         ///< the opened nodes; 0 for a cluster that was opened, and between
    /// At first the sums over every kStride-th place, from each of the first on; then, in turn, as
    /// many sums of the i-th of these and the i-th of their second half, to the last, of all.
    float sums[2 * kStride];
    std::uint32_t size;                ///< number of places
    std::uint32_t first_opened;        ///< place of the first child of the first opened node
    std::uint32_t opened_count;        ///< number of opened nodes
    std::uint32_t opened[kMaxOpened];  ///< opened nodes of the tree

    float total() const noexcept { return sums[2 * kStride - 2]; }

    /// The cluster of a place, in the form of BoundsNode::child.
    std::uint32_t child(const LightBvh<MeansNode>& bvh, const ClusterCut& cut,
                        std::uint32_t place) const noexcept {
        if (place < first_opened) return cut.child[place];
        const std::uint32_t i = place - first_opened;
        return bvh.nodes[opened[i / kWidth]].child[i % kWidth];
    }
};

/// A cluster that was chosen out of a cut.
struct CutChoice {
    std::uint32_t place;  ///< place among the weights
    double within;        ///< place in the cluster's share where the choice fell, [0, 1)
};

/// Chooses a cluster in proportion to its weight, by a number in [0, 1). Their total must not
/// be 0.
CutChoice choose(const CutWeights& weights, double number) noexcept;

}  // namespace lightcull
