#pragma once

#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "lights/glossy/directed_light.h"
#include "lights/ranges/ranges.h"
#include "lights/ranges/sphere_tree.h"
#include "lights/ranges/sphere_tree_walk.h"

namespace lightcull {

/// A sphere tree over the volumes of lights whose acceptance depends on direction. A range moves
/// their centres too, so each set has spheres of its own all the way up. Lights are numbered by
/// record, in the order of the tree's leaves.
class InfluenceTree {
  public:
    /// records: those of lit lights. The tree has no ranges before the first begin_pass().
    InfluenceTree(Span<const LightRecord> records, const RandomRanges& ranges);

    /// Makes a tree with the ranges of another pass over the same lights, which both share.
    InfluenceTree(const InfluenceTree& other, std::uint64_t pass);

    /// Draws all ranges of the pass and places the spheres. Runs in the caller's TBB arena.
    void begin_pass(std::uint64_t pass);

    const RandomRanges& ranges() const noexcept { return ranges_; }
    const DirectedLight& light(std::uint32_t record) const noexcept {
        return shared_->lights[record];
    }
    /// The index of each record in what the tree was built over.
    const std::vector<std::uint32_t>& order() const noexcept { return shared_->order; }

    /// Calls visit(Span of records) for whatever may be accepted at a point in `set`, some at a
    /// time, but for what lies below its horizon. Returns the number of nodes read.
    template <typename Visit>
    std::uint32_t for_near(const Receiver& receiver, std::uint32_t set,
                           Visit&& visit) const noexcept {
        const SphereTree& tree = of_set_[set];
        return traverse(tree, radii_.data() + set * tree.slot_count(), receiver, visit);
    }

    /// True if p_i > xi_i at a distance as DirectedLight has it.
    bool accepts(std::uint32_t record, std::uint32_t set, float distance) const noexcept {
        return distance <= range(record, set);
    }
    /// The inverse 1 / p at a distance as DirectedLight has it.
    float inverse_prob(std::uint32_t record, float distance) const noexcept {
        return ranges_.inverse_prob(shared_->lights[record].intensity(), distance);
    }

    std::size_t memory_size() const noexcept;

  private:
    float range(std::uint32_t record, std::uint32_t set) const noexcept {
        return ranges_.range(shared_->lights[record].intensity(), ranges_.xi(record, set));
    }
    void place(std::uint32_t set);

    /// The part of the tree that does not change from pass to pass.
    struct Shared {
        std::vector<std::uint32_t> order;
        std::vector<DirectedLight> lights;
    };

    RandomRanges ranges_;
    std::shared_ptr<const Shared> shared_;
    std::vector<SphereTree> of_set_;  ///< nodes alone, of one topology, where the set has them
    std::vector<float> radii_;        ///< [set][node][slot]
};

}  // namespace lightcull
