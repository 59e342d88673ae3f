#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/learning/cluster_cut.h"
#include "lights/learning/leaf_order.h"

namespace lightcull {

/// The lights of a tree one by one, for points at which each is weighed. They have places in rows
/// of kColumns; a column holds lights that follow one another in the order of the leaves.
class LightRows {
  public:
    static constexpr std::size_t kColumns = 16;
    /// The most lights that there may be.
    static constexpr std::uint32_t kMost = 2048;

    /// Lights of one row; those after the last light are empty ones, of importance 0.
    struct alignas(64) Row : ClusterMeans<kColumns> {};

    LightRows(const LightBvh<MeansNode>& bvh, const LeafOrder& leaves);

    const std::vector<Row>& rows() const noexcept { return rows_; }
    std::size_t place_of_leaf(std::uint32_t leaf) const noexcept {
        return leaf % rows_.size() * kColumns + leaf / rows_.size();
    }
    /// The light of a place, in the form of BoundsNode::child.
    std::uint32_t child(std::size_t place) const noexcept {
        return rows_[place / kColumns].child[place % kColumns];
    }
    std::size_t memory_size() const noexcept { return rows_.capacity() * sizeof(Row); }

  private:
    std::vector<Row> rows_;
};

/// What the importance of each light is multiplied by, by place: what a cell sees of its cluster.
struct alignas(64) LightFactors {
    float of[LightRows::kMost];

    void set(const LightRows& lights, const LeafOrder& leaves, const ClusterCut& cut) noexcept;
};

/// The weights of lights at a point, by place, and their sums.
struct alignas(64) LightWeights {
    float of[LightRows::kMost];
    float columns[LightRows::kColumns];
    float total;
};

/// A light that was chosen.
struct LightChoice {
    std::uint32_t child;  ///< in the form of BoundsNode::child
    double prob;
};

/// Chooses a light in proportion to its weight, by a number in [0, 1), in the order of the leaves:
/// numbers that are close choose lights that are. Their total must not be 0.
LightChoice choose(const LightRows& lights, const LightWeights& weights, double number) noexcept;

}  // namespace lightcull
