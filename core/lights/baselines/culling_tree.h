#pragma once

#include <lightcull/light_sampler.h>
#include <lightcull/sampler_info.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "lights/light/importance.h"
#include "lights/light/light_record.h"
#include "lights/light/ordered_lights.h"
#include "lights/ranges/range_tree.h"

namespace lightcull {

/// A light whose range covers the point.
struct Accepted {
    std::uint32_t record;
    float importance;    ///< g, > 0
    float inverse_prob;  ///< 1 / p, >= 1
};

/// A RangeTree in which each light has a range of its own, as in [TH16]. to_record() and to_light()
/// translate between its numbers and the caller's. Points are in the units of frame().
class CullingTree {
  public:
    CullingTree(const LightTable& table, const RandomRanges& ranges);

    /// Makes a tree with the ranges of another pass over the same lights, which both share.
    CullingTree(const CullingTree& other, std::uint64_t pass);

    void begin_pass(std::uint64_t pass) { tree_.begin_pass(pass); }

    const Frame& frame() const noexcept { return frame_; }
    const RandomRanges& ranges() const noexcept { return tree_.ranges(); }
    const RangeTree& tree() const noexcept { return tree_; }
    const LightRecord& record(std::uint32_t record) const noexcept {
        return lights_->records[record];
    }

    // The lights by record, for back ends.
    const std::vector<LightRecord>& records() const noexcept { return lights_->records; }
    const std::vector<std::uint32_t>& lights() const noexcept { return lights_->lights; }

    std::size_t light_count() const noexcept { return lights_->record_of.size(); }

    static constexpr std::uint32_t kNoRecord = OrderedLights::kNoRecord;
    /// The record of a light; kNoRecord for a light of intensity 0.
    std::uint32_t to_record(std::uint32_t light) const noexcept {
        return lights_->record_of[light];
    }
    std::uint32_t to_light(std::uint32_t record) const noexcept { return lights_->lights[record]; }

    /// Calls visit(Accepted) for every light that is accepted at a point in `set` and can reach it.
    template <typename Visit>
    SelectionCounts for_each_accepted(const Receiver& receiver, std::uint32_t set,
                                      Visit&& visit) const noexcept {
        SelectionCounts counts;
        const auto weigh = [&](std::uint32_t record) {
            ++counts.lights_tested;
            const Approach way = approach(receiver.position, lights_->records[record].center);
            const float g = importance(lights_->records[record], way, receiver);
            if (!(g > 0.0f)) return;
            ++counts.accepted;
            visit(Accepted{record, g, tree_.inverse_prob(record, way)});
        };
        counts.nodes_visited =
            tree_.for_accepted(receiver, set, [&](Span<const std::uint32_t> records) {
                for (const std::uint32_t record : records) weigh(record);
            });
        return counts;
    }

    std::size_t memory_size() const noexcept;

  private:
    Frame frame_;
    RangeTree tree_;
    std::shared_ptr<const OrderedLights> lights_;
};

}  // namespace lightcull
