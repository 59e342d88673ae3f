#include <lightcull/samplers.h>

#include <algorithm>
#include <utility>

#include "lights/culling_tree.h"
#include "lights/range_calibration.h"
#include "lights/reservoir.h"
#include "lights/set_count.h"

namespace lightcull {
namespace {

/// Every accepted light is weighed by g / p while the tree is walked, and one is kept. The mean
/// over xi of [i accepted] (g_i / p_i) / W / prob is 1 for prob = g_i / W.
class CulledSampler final : public LightSampler {
  public:
    CulledSampler(const LightTable& table, float reach, std::uint32_t set_count)
        : tree_(table, reach, set_count) {}

    using LightSampler::select;

    void begin_pass(std::uint64_t pass) override { tree_.begin_pass(pass); }

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        Reservoir reservoir(u);
        const float3 x = tree_.frame().position(point.position);
        tree_.for_each_accepted(x, point.normal, point.set, [&](const Accepted& accepted) {
            reservoir.add(accepted.record, accepted.importance,
                          accepted.importance / accepted.prob);
        });
        const Reservoir::Choice& choice = reservoir.finish();
        const Receipt receipt{reservoir.weight_sum(), point.set};
        if (choice.weight == 0.0f) return {0, 0.0f, receipt};
        return {tree_.to_light(choice.light), choice.numerator / receipt.weight_sum, receipt};
    }

    /// Points of one set after the other, so that the radii of one are read at a time.
    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const noexcept override {
        std::uint32_t next_of_set[kMaxSetCount];
        std::uint32_t order[kOrderedPoints];
        for (std::size_t begin = 0; begin < points.size(); begin += kOrderedPoints) {
            const std::size_t count = std::min(points.size() - begin, kOrderedPoints);
            order_by_set({points.data() + begin, count}, next_of_set, order);
            for (std::size_t i = 0; i < count; ++i) {
                const std::size_t at = begin + order[i];
                selections[at] = select(points[at], u[at]);
            }
        }
    }

    /// g_i / W', with W' = W if light i was accepted, else W + w_i (DESIGN section 3, MIS).
    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        const std::uint32_t record = tree_.to_record(light);
        if (record == CullingTree::kNoRecord) return 0.0f;
        const LightRecord& data = tree_.record(record);
        const Approach way = approach(tree_.frame().position(point.position), data.center);
        const float g = importance(data, way, point.normal);
        if (!(g > 0.0f)) return 0.0f;
        const RandomRanges& ranges = tree_.ranges();
        const float distance = distance_to_sphere(way.distance, data);
        if (ranges.accepts(data.intensity, distance, ranges.xi(record, receipt.key))) {
            return g / receipt.weight_sum;
        }
        return g / (receipt.weight_sum + g / ranges.prob(data.intensity, distance));
    }

    std::uint32_t set_count() const noexcept override { return tree_.ranges().set_count(); }

    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        return tree_.for_each_accepted(tree_.frame().position(point.position), point.normal,
                                       point.set, [](const Accepted&) {});
    }

  private:
    static constexpr std::size_t kOrderedPoints = 8192;

    /// Counting sort.
    void order_by_set(Span<const ShadingPoint> points, std::uint32_t* next_of_set,
                      std::uint32_t* order) const noexcept {
        std::fill_n(next_of_set, set_count(), 0u);
        for (const ShadingPoint& point : points) ++next_of_set[point.set];
        std::uint32_t sum = 0;
        for (std::uint32_t set = 0; set < set_count(); ++set) {
            sum += std::exchange(next_of_set[set], sum);
        }
        for (std::uint32_t i = 0; i < points.size(); ++i) order[next_of_set[points[i].set]++] = i;
    }

    CullingTree tree_;
};

}  // namespace

std::unique_ptr<LightSampler> make_culled_sampler(Span<const Light> lights,
                                                  const CulledOptions& options) {
    check_set_count(options.set_count);
    const LightTable table = make_light_table(lights);
    const float reach = calibrate_reach(table, options.range, RangeLaw::kRandom);
    return std::make_unique<CulledSampler>(table, reach, options.set_count);
}

}  // namespace lightcull
