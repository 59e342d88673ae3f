#pragma once

#include <lightcull/light_sampler.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/importance.h"
#include "lights/ranges.h"
#include "lights/sphere_tree.h"
#include "lights/sphere_tree_refit.h"
#include "lights/sphere_tree_walk.h"

namespace lightcull {

/// A light whose range covers the point.
struct Accepted {
    std::uint32_t record;
    float importance;    ///< g, > 0
    float inverse_prob;  ///< 1 / p, >= 1
};

/// The sphere tree with the random ranges of a pass: finds the lights that are accepted at a point.
/// Lights are numbered by record; to_record() and to_light() translate. Points are in the units of
/// frame().
class CullingTree {
  public:
    CullingTree(const LightTable& table, const RandomRanges& ranges);

    /// Draws all ranges of the pass and refits the tree, set by set.
    void begin_pass(std::uint64_t pass);

    const Frame& frame() const noexcept { return frame_; }
    const RandomRanges& ranges() const noexcept { return ranges_; }
    const SphereTree& tree() const noexcept { return tree_; }
    /// [node][slot]
    const float* radii(std::uint32_t set) const noexcept {
        return radii_.data() + set * tree_.slot_count();
    }
    const LightRecord& record(std::uint32_t record) const noexcept { return tree_.records[record]; }

    static constexpr std::uint32_t kNoRecord = 0xffffffffu;
    /// kNoRecord for a light of intensity 0.
    std::uint32_t to_record(std::uint32_t light) const noexcept { return record_of_[light]; }
    std::uint32_t to_light(std::uint32_t record) const noexcept { return tree_.lights[record]; }

    /// Calls visit(Accepted) for every light that is accepted at x in `set` and can reach it. Units
    /// of frame().
    template <typename Visit>
    SelectionCounts for_each_accepted(float3 x, const Receiver& receiver, std::uint32_t set,
                                      Visit&& visit) const noexcept {
        SelectionCounts counts;
        counts.nodes_visited =
            traverse(tree_, radii(set), x, receiver.normal, [&](std::uint32_t record) {
                ++counts.lights_tested;
                const LightRecord& light = tree_.records[record];
                const Approach way = approach(x, light.center);
                const float g = importance(light, way, receiver);
                if (!(g > 0.0f)) return;
                ++counts.accepted;
                visit(Accepted{record, g, inverse_prob(light, way)});
            });
        return counts;
    }

    /// Whether a light's range covers the point: to the bit what for_each_accepted() finds.
    bool accepts(std::uint32_t record, std::uint32_t set, const Approach& way) const noexcept {
        const LightRecord& light = tree_.records[record];
        return is_within(way, light, ranges_.range(light.intensity, ranges_.xi(record, set)));
    }

    /// 1 / p_i.
    float inverse_prob(const LightRecord& light, const Approach& way) const noexcept {
        return ranges_.inverse_prob(light.intensity, distance_to_sphere(way.distance, light));
    }

    std::size_t memory_size() const noexcept;

  private:
    /// The radii of sets [first_set, first_set + set_count).
    void refit(std::uint32_t first_set, std::uint32_t set_count);

    Frame frame_;
    RandomRanges ranges_;
    SphereTree tree_;
    RefitOrder refit_order_;
    std::vector<std::uint32_t> record_of_;  ///< by light
    std::vector<float> radii_;              ///< [set][node][slot]
    std::vector<float> around_;             ///< what a refit works with
};

}  // namespace lightcull
