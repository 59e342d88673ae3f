#include "base/reservoir.h"
#include "lights/baselines/culling_tree.h"
#include "lights/baselines/make_baselines.h"
#include "lights/calibration/range_calibration.h"
#include "lights/samplers/passless_sampler.h"

namespace lightcull {
namespace {

/// Chooses every light within its constant range in proportion to importance, and none beyond its
/// range: [TH16] appendix A.
class ClampedSampler final : public PasslessSampler<ClampedSampler> {
  public:
    ClampedSampler(const LightTable& table, float reach)
        : tree_([&] {
              CullingTree tree(table, RandomRanges(reach, 1, RangeLaw::kConstant));
              tree.begin_pass(0);
              return std::make_shared<const CullingTree>(std::move(tree));
          }()) {}

    using LightSampler::select;

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        Reservoir reservoir(u);
        for_each_in_range(point, [&](const Accepted& accepted) {
            reservoir.add(accepted.record, accepted.importance, accepted.importance);
        });
        const Receipt receipt{reservoir.weight_sum(), 0};
        if (!reservoir.chosen()) return {0, 0.0f, 0.0f, receipt};
        const float prob = reservoir.prob();
        return {tree_->to_light(reservoir.light()), prob, prob, receipt};
    }

    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        const std::uint32_t record = tree_->to_record(light);
        if (record == CullingTree::kNoRecord) return 0.0f;
        const LightRecord& data = tree_->record(record);
        const Receiver receiver(tree_->frame(), point);
        const Approach way = approach(receiver.position, data.center);
        if (!tree_->tree().accepts(record, 0, way)) return 0.0f;
        const float g = importance(data, way, receiver);
        return g > 0.0f ? g / receipt.weight_sum : 0.0f;
    }

    LightUpdate update(Span<const Light> lights, float) override {
        const LightTable table = make_updated_light_table(lights, tree_->light_count());
        *this =
            ClampedSampler(table, reach_in(table.frame, tree_->ranges().reach(), tree_->frame()));
        return {true, 1.0f};
    }

    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        return for_each_in_range(point, [](const Accepted&) {});
    }

    std::size_t memory_size() const noexcept override { return tree_->memory_size(); }

  private:
    template <typename Visit>
    SelectionCounts for_each_in_range(const ShadingPoint& point, Visit&& visit) const noexcept {
        return tree_->for_each_accepted(Receiver(tree_->frame(), point), 0, visit);
    }

    std::shared_ptr<const CullingTree> tree_;
};

}  // namespace

std::unique_ptr<LightSampler> make_clamped_sampler(const ClampedOptions& options,
                                                   Span<const Light> lights,
                                                   const SamplerContext& context) {
    const LightTable table = make_light_table(lights);
    return std::make_unique<ClampedSampler>(
        table, calibrate_reach(ranged_scene(table), options.range, context.calibration_points,
                               RangeLaw::kConstant));
}

}  // namespace lightcull
