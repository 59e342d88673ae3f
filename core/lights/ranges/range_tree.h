#pragma once

#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/core_export.h"
#include "lights/ranges/ranges.h"
#include "lights/ranges/sphere_tree.h"
#include "lights/ranges/sphere_tree_refit.h"
#include "lights/ranges/sphere_tree_walk.h"

namespace lightcull {

/// The sphere tree with the random ranges of a pass: finds what is accepted at a point. Lights are
/// numbered by record, in the order of the tree's leaves.
class LIGHTCULL_CORE_EXPORT RangeTree {
  public:
    /// Makes a tree that has no ranges before the first begin_pass().
    RangeTree(Span<const RangedLight> lights, const RandomRanges& ranges);

    /// Makes a tree with the ranges of another pass over the same topology, which both share.
    RangeTree(const RangeTree& other, std::uint64_t pass);

    /// Takes lights that have changed, by record, and ranges of as many sets. The topology stays. It
    /// has no ranges before the next begin_pass(). Trees of other passes keep what they have; where
    /// memory lacks, so does this one.
    void update(Span<const RangedLight> records, const RandomRanges& ranges);

    /// Draws all ranges of the pass and refits the tree. Runs in the caller's TBB arena.
    void begin_pass(std::uint64_t pass);

    const RandomRanges& ranges() const noexcept { return ranges_; }
    const SphereTree& tree() const noexcept { return topology_->tree; }
    const RangedLight& record(std::uint32_t record) const noexcept {
        return tree().records[record];
    }
    /// The radii of a set: [node][slot].
    const float* radii(std::uint32_t set) const noexcept {
        return radii_.data() + set * tree().slot_count();
    }

    /// Calls visit(Span of records) for whatever is accepted at a point in `set`, some at a time,
    /// but for what lies below its horizon. Returns the number of nodes read.
    template <typename Visit>
    std::uint32_t for_accepted(const Receiver& receiver, std::uint32_t set,
                               Visit&& visit) const noexcept {
        return traverse(tree(), radii(set), receiver, visit);
    }

    /// True if a range covers the point: to the bit what for_accepted() finds.
    bool accepts(std::uint32_t record, std::uint32_t set, const Approach& way) const noexcept {
        return ranges_.accepts(tree().records[record], way, ranges_.xi(record, set));
    }

    /// The inverse 1 / p along a way.
    float inverse_prob(std::uint32_t record, const Approach& way) const noexcept {
        const RangedLight& light = tree().records[record];
        return ranges_.inverse_prob(light.intensity, light.distance(way));
    }

    std::size_t memory_size() const noexcept;

  private:
    /// The part of the tree that does not change from pass to pass.
    struct Topology {
        SphereTree tree;
        RefitOrder refit_order;
    };

    /// Computes the radii of sets [first_set, first_set + set_count).
    void refit(std::uint32_t first_set, std::uint32_t set_count, float* around);

    RandomRanges ranges_;
    std::shared_ptr<const Topology> topology_;
    std::vector<float> radii_;  ///< [set][node][slot]
};

}  // namespace lightcull
