#include "lights/glossy/directed_culled_sampler.h"

#include <lightcull/sampler_info.h>

#include <utility>
#include <vector>

#include "base/reservoir.h"
#include "lights/glossy/influence_tree.h"
#include "lights/light/importance.h"
#include "lights/light/ordered_lights.h"

namespace lightcull {
namespace {

std::vector<LightRecord> lit_records(const LightTable& table) {
    std::vector<LightRecord> records;
    records.reserve(table.lit.size());
    for (const std::uint32_t i : table.lit) records.push_back(table.records[i]);
    return records;
}

/// Weighs every accepted light by g / p while the tree is walked and keeps one; the probability of
/// light i is g_i / W (design.md, "The estimator").
class DirectedCulledSampler final : public DirectedCulledSamplerBase, public SamplerInfo {
  public:
    DirectedCulledSampler(const LightTable& table, const RandomRanges& ranges)
        : frame_(table.frame),
          tree_(lit_records(table), ranges),
          lights_(std::make_shared<const OrderedLights>(table, tree_.order())) {}

    DirectedCulledSampler(const DirectedCulledSampler& other, std::uint64_t pass)
        : frame_(other.frame_), tree_(other.tree_, pass), lights_(other.lights_) {}

    using LightSampler::select;

    void begin_pass(std::uint64_t pass) override { tree_.begin_pass(pass); }

    std::unique_ptr<const LightSelector> pass(std::uint64_t number) const override {
        return std::make_unique<DirectedCulledSampler>(*this, number);
    }

    LightUpdate update(Span<const Light> lights, float) override {
        const LightTable table = make_updated_light_table(lights, lights_->record_of.size());
        *this = DirectedCulledSampler(
            table,
            RandomRanges(reach_in(table.frame, tree_.ranges().reach(), frame_), set_count()));
        return {true, 1.0f};
    }

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        Reservoir reservoir(u);
        for_each_accepted(point, [&](std::uint32_t record, float g, float inverse_prob) {
            reservoir.add(record, g, g * inverse_prob);
        });
        const Receipt receipt{reservoir.weight_sum(), point.set};
        if (!reservoir.chosen()) return {0, 0.0f, 0.0f, receipt};
        const float prob = reservoir.prob();
        return {lights_->lights[reservoir.light()], prob, prob, receipt};
    }

    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        const std::uint32_t record = lights_->record_of[light];
        if (record == OrderedLights::kNoRecord) return 0.0f;
        const LightRecord& of_light = lights_->records[record];
        const Receiver receiver(frame_, point);
        const Approach way = approach(receiver.position, of_light.center);
        const float g = importance(of_light, way, receiver);
        if (!(g > 0.0f)) return 0.0f;
        const float distance = tree_.light(record).distance(way);
        const bool accepted = tree_.accepts(record, receipt.key, distance);
        const float as_if = accepted ? 0.0f : g * tree_.inverse_prob(record, distance);
        return g / (receipt.weight_sum + as_if);
    }

    std::uint32_t set_count() const noexcept override { return tree_.ranges().set_count(); }

    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        return for_each_accepted(point, [](std::uint32_t, float, float) {});
    }

    std::size_t memory_size() const noexcept override {
        return tree_.memory_size() + lights_->memory_size();
    }

  private:
    /// Calls visit(record, g, 1 / p) for every light that is accepted at the point and can reach
    /// it.
    template <typename Visit>
    SelectionCounts for_each_accepted(const ShadingPoint& point, Visit&& visit) const noexcept {
        SelectionCounts counts;
        const Receiver receiver(frame_, point);
        const auto weigh = [&](std::uint32_t record) {
            ++counts.lights_tested;
            const Approach way = approach(receiver.position, lights_->records[record].center);
            const float distance = tree_.light(record).distance(way);
            if (!tree_.accepts(record, point.set, distance)) return;
            const float g = importance(lights_->records[record], way, receiver);
            if (!(g > 0.0f)) return;
            ++counts.accepted;
            visit(record, g, tree_.inverse_prob(record, distance));
        };
        counts.nodes_visited =
            tree_.for_near(receiver, point.set, [&](Span<const std::uint32_t> records) {
                for (const std::uint32_t record : records) weigh(record);
            });
        return counts;
    }

    Frame frame_;
    InfluenceTree tree_;
    std::shared_ptr<const OrderedLights> lights_;
};

}  // namespace

std::unique_ptr<LightSampler> make_directed_culled_sampler(const LightTable& table, float reach,
                                                           std::uint32_t set_count) {
    return std::make_unique<DirectedCulledSampler>(table, RandomRanges(reach, set_count));
}

}  // namespace lightcull
