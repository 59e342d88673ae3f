#include <lightcull/samplers.h>

#include "base/reservoir.h"
#include "lights/baselines/culling_tree.h"
#include "lights/calibration/range_calibration.h"

namespace lightcull {
namespace {

/// Every light within its constant range, in proportion to importance; beyond it, none: [TH16]
/// appendix A.
class ClampedSampler final : public LightSampler {
  public:
    ClampedSampler(const LightTable& table, float reach)
        : tree_(table, RandomRanges(reach, 1, RangeLaw::kConstant)) {
        tree_.begin_pass(0);
    }

    using LightSampler::select;

    void begin_pass(std::uint64_t) override {}

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        Reservoir reservoir(u);
        for_each_in_range(point, [&](const Accepted& accepted) {
            reservoir.add(accepted.record, accepted.importance, accepted.importance);
        });
        const Receipt receipt{reservoir.weight_sum(), 0};
        if (!reservoir.chosen()) return {0, 0.0f, receipt};
        return {tree_.to_light(reservoir.light()), reservoir.prob(), receipt};
    }

    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        const std::uint32_t record = tree_.to_record(light);
        if (record == CullingTree::kNoRecord) return 0.0f;
        const LightRecord& data = tree_.record(record);
        const Approach way = approach(tree_.frame().position(point.position), data.center);
        if (!tree_.tree().accepts(record, 0, way)) return 0.0f;
        const float g = importance(data, way, Receiver(point));
        return g > 0.0f ? g / receipt.weight_sum : 0.0f;
    }

    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        return for_each_in_range(point, [](const Accepted&) {});
    }

    std::size_t memory_size() const noexcept override { return tree_.memory_size(); }

  private:
    template <typename Visit>
    SelectionCounts for_each_in_range(const ShadingPoint& point, Visit&& visit) const noexcept {
        return tree_.for_each_accepted(tree_.frame().position(point.position), Receiver(point), 0,
                                       visit);
    }

    CullingTree tree_;
};

}  // namespace

std::unique_ptr<LightSampler> make_clamped_sampler(Span<const Light> lights,
                                                   const RangeOptions& options) {
    const LightTable table = make_light_table(lights);
    return std::make_unique<ClampedSampler>(
        table, calibrate_reach(ranged_scene(table), options, RangeLaw::kConstant));
}

}  // namespace lightcull
