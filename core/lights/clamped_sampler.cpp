#include <lightcull/samplers.h>

#include <array>
#include <vector>

#include "lights/importance.h"
#include "lights/range_calibration.h"
#include "lights/ranges.h"
#include "lights/reservoir.h"
#include "lights/sphere_tree.h"
#include "lights/sphere_tree_refit.h"
#include "lights/sphere_tree_traverse.h"

namespace lightcull {
namespace {

/// Every light within its constant range, in proportion to importance; beyond it, none: [TH16]
/// appendix A.
class ClampedSampler final : public LightSampler {
  public:
    ClampedSampler(LightTable table, float reach)
        : table_(std::move(table)),
          ranges_(reach, 1),
          tree_(build_sphere_tree(table_, reach)),
          radii_(tree_.slot_count()) {
        const auto ranges_of = [&](std::uint32_t record, std::array<float, 1>& out) {
            out[0] = ranges_.range(tree_.records[record].intensity, 1.0f);
        };
        refit_radii<1>(tree_, ranges_of, radii_.data());
    }

    using LightSampler::select;

    void begin_pass(std::uint64_t) override {}

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        Reservoir reservoir(u);
        for_each_in_range(point,
                          [&](std::uint32_t record, float g) { reservoir.add(record, g, g); });
        const Receipt receipt{reservoir.weight_sum(), 0};
        if (!reservoir.chosen()) return {0, 0.0f, receipt};
        return {tree_.lights[reservoir.light()], reservoir.prob(), receipt};
    }

    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        const LightRecord& data = table_.records[light];
        const float g =
            importance_in_range(data, table_.frame.position(point.position), point.normal);
        return g > 0.0f ? g / receipt.weight_sum : 0.0f;
    }

    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        SelectionCounts counts;
        counts.nodes_visited =
            for_each_in_range(point, [&](std::uint32_t, float) { ++counts.accepted; });
        counts.lights_tested = counts.accepted;
        return counts;
    }

  private:
    /// 0 out of range.
    float importance_in_range(const LightRecord& light, float3 x, float3 normal) const noexcept {
        const Approach way = approach(x, light.center);
        const float distance = distance_to_sphere(way.distance, light);
        if (!ranges_.accepts(light.intensity, distance, 1.0f)) return 0.0f;
        return importance(light, way, normal);
    }

    template <typename Visit>
    std::uint32_t for_each_in_range(const ShadingPoint& point, Visit&& visit) const noexcept {
        const float3 x = table_.frame.position(point.position);
        return traverse(tree_, radii_.data(), x, [&](std::uint32_t record) {
            const float g = importance_in_range(tree_.records[record], x, point.normal);
            if (g > 0.0f) visit(record, g);
        });
    }

    LightTable table_;
    RandomRanges ranges_;
    SphereTree tree_;
    std::vector<float> radii_;
};

}  // namespace

std::unique_ptr<LightSampler> make_clamped_sampler(Span<const Light> lights,
                                                   const RangeOptions& options) {
    LightTable table = make_light_table(lights);
    const float reach = calibrate_reach(table, options, RangeLaw::kConstant);
    return std::make_unique<ClampedSampler>(std::move(table), reach);
}

}  // namespace lightcull
