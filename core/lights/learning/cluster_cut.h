#pragma once

#include <cstddef>
#include <cstdint>

#include "lights/bvh/light_bvh.h"

namespace lightcull {

/// A cut through a light BVH: clusters that together hold each lit light once, each with what a
/// cell sees of it. They are numbered in the order of the tree's leaves, and have places in the
/// order in which they are weighed: near ones first. What is weighed stands by place, and the
/// places after the last cluster are empty ones, of importance 0.
struct alignas(64) ClusterCut : ClusterMeans<128> {
    static constexpr std::uint32_t kMaxSize = 128;
    /// Near and far clusters fill as many places each, or a multiple.
    static constexpr std::uint32_t kBlock = 16;

    float scale[kMaxSize];      ///< by place: factor of a cluster's importance, above 0: `visible`
                                ///< by what its parts together give the cell, relative
                                ///< to what it is taken to give as a whole
    float far_scale[kMaxSize];  ///< by place: of a far cluster, what is not due to the receiver's
                                ///< cosine, which alone varies over the cell; 0 elsewhere
    float visible[kMaxSize];    ///< factor of what is seen of a cluster, (0, 1]; 1: not tried
    std::uint32_t first_leaf[kMaxSize];  ///< first leaf of a cluster (LeafOrder), ascending
    LightBvhSlot slot[kMaxSize];         ///< slot of the tree that holds a cluster
    std::uint8_t place_of[kMaxSize];     ///< place of a cluster
    std::uint8_t cluster_at[kMaxSize];   ///< cluster of a place
    std::uint8_t run[2 * kBlock];        ///< runs in the order in which choose() goes through them:
                                         ///< see CutWeights::sums
    std::uint32_t size = 0;              ///< number of clusters
    std::uint32_t near_size = 0;         ///< place of the first far one, a multiple of kBlock
    bool by_light = false;  ///< true where the clusters are misjudged, and each light is weighed

    ClusterCut() noexcept { clear(); }
    void clear() noexcept;

    /// The cluster that holds a leaf. The cut must not be empty.
    std::uint32_t cluster_of_leaf(std::uint32_t leaf) const noexcept;
};

/// The weights of the clusters of a cut at a receiver: importance by `scale`, or `far_scale` by
/// what the receiver's cosine makes of it; and their sums. Where a receiver has a lobe, or is in a
/// volume, there are no far clusters. Where it has a lobe, clusters too wide to tell what of them
/// lies in it are replaced by the children of their nodes, by `visible`.
struct alignas(64) CutWeights {
    static constexpr std::size_t kStride = ClusterCut::kBlock;
    static constexpr std::size_t kRuns = 2 * kStride;
    static constexpr std::uint32_t kWidth = LightBvhNode::kWidth;
    static constexpr std::uint32_t kMaxOpened = 16;
    static constexpr std::uint32_t kMaxSize = ClusterCut::kMaxSize + kMaxOpened * kWidth;

    float of[kMaxSize];  ///< weights: first by place in the cut, from first_opened on by place in
                         ///< the opened nodes; 0 for a cluster that was opened, and between
    /// A run is every kStride-th place from one of the first on, of what was weighed as near (runs
    /// 0 to kStride - 1) or of the others. At first their sums, in the order of ClusterCut::run;
    /// then, in turn, as many sums of the i-th of these and the i-th of their second half, to the
    /// last, of all.
    float sums[2 * kRuns];
    std::uint32_t size;          ///< number of places
    std::uint32_t near_size;     ///< number of places of clusters that were weighed as near ones
    std::uint32_t first_opened;  ///< place of the first child of the first opened node
    std::uint32_t opened_count;  ///< number of opened nodes
    std::uint32_t opened[kMaxOpened];  ///< opened nodes of the tree

    float total() const noexcept { return sums[2 * kRuns - 2]; }

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

/// Chooses a cluster in proportion to its weight, by a number in [0, 1). Their total must not be 0.
/// Runs are chosen from in the order of the tree's leaves, about: numbers that are close choose
/// clusters that are.
CutChoice choose(const ClusterCut& cut, const CutWeights& weights, double number) noexcept;

}  // namespace lightcull
