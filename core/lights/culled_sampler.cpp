#include <lightcull/samplers.h>

#include <algorithm>
#include <vector>

#include "lights/culling_tree.h"
#include "lights/kernels.h"
#include "lights/parallel_blocks.h"
#include "lights/point_order.h"
#include "lights/range_calibration.h"
#include "lights/reservoir.h"
#include "lights/set_count.h"

namespace lightcull {
namespace {

/// Every accepted light is weighed by g / p while the tree is walked, and one is kept. The mean
/// over xi of [i accepted] (g_i / p_i) / W / prob is 1 for prob = g_i / W.
class CulledSampler final : public LightSampler {
  public:
    CulledSampler(const LightTable& table, const RandomRanges& ranges) : tree_(table, ranges) {}

    using LightSampler::select;

    void begin_pass(std::uint64_t pass) override { tree_.begin_pass(pass); }

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        Reservoir reservoir(u);
        const float3 x = tree_.frame().position(point.position);
        tree_.for_each_accepted(x, Receiver(point), point.set, [&](const Accepted& accepted) {
            reservoir.add(accepted.record, accepted.importance,
                          accepted.importance * accepted.inverse_prob);
        });
        const Receipt receipt{reservoir.weight_sum(), point.set};
        if (!reservoir.chosen()) return {0, 0.0f, receipt};
        return {tree_.to_light(reservoir.light()), reservoir.prob(), receipt};
    }

    /// Sixteen points at a time, of one set and near each other.
    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const noexcept override {
        const std::vector<std::uint32_t> order = order_points(points, set_count());
        constexpr std::size_t kBlock = 16 * PointPacket::kSize;
        for_each_block(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            while (begin < end) {
                begin += select_some({order.data() + begin, end - begin}, points, u, selections);
            }
        });
    }

    /// g_i / W', with W' = W if light i was accepted, else W + w_i (DESIGN section 3, MIS).
    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        const std::uint32_t record = tree_.to_record(light);
        if (record == CullingTree::kNoRecord) return 0.0f;
        const LightRecord& data = tree_.record(record);
        const Approach way = approach(tree_.frame().position(point.position), data.center);
        const float g = importance(data, way, Receiver(point));
        if (!(g > 0.0f)) return 0.0f;
        if (tree_.accepts(record, receipt.key, way)) return g / receipt.weight_sum;
        return g / (receipt.weight_sum + g * tree_.inverse_prob(data, way));
    }

    std::uint32_t set_count() const noexcept override { return tree_.ranges().set_count(); }

    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        return tree_.for_each_accepted(tree_.frame().position(point.position), Receiver(point),
                                       point.set, [](const Accepted&) {});
    }

    std::size_t memory_size() const noexcept override { return tree_.memory_size(); }

  private:
    /// As many of the points that `order` names as go into one packet; their number.
    std::size_t select_some(Span<const std::uint32_t> order, Span<const ShadingPoint> points,
                            Span<const float> u, Span<Selection> selections) const noexcept {
        const std::uint32_t set = points[order[0]].set;
        PacketBuilder builder(set);
        const auto add = [&](std::uint32_t i) {
            builder.add(points[i], tree_.frame().position(points[i].position), u[i]);
        };
        std::size_t count = 0;
        while (count < std::min(order.size(), PointPacket::kSize) &&
               points[order[count]].set == set) {
            add(order[count++]);
        }
        while (builder.size() < PointPacket::kSize) add(order[0]);  // to fill it
        PacketChoice choice{};
        kernels().select_packet(tree_, builder.packet(), choice);
        for (std::size_t i = 0; i < count; ++i) {
            const float sum = choice.weight_sum[i];
            Selection& selection = selections[order[i]];
            selection = {0, 0.0f, {sum, set}};
            if (!(sum > 0.0f)) continue;
            selection.light = tree_.to_light(choice.record[i]);
            selection.prob = choice.numerator[i] / sum;
        }
        return count;
    }

    CullingTree tree_;
};

}  // namespace

std::unique_ptr<LightSampler> make_culled_sampler(Span<const Light> lights,
                                                  const CulledOptions& options) {
    check_set_count(options.set_count);
    const LightTable table = make_light_table(lights);
    const float reach = calibrate_reach(table, options.range, RangeLaw::kRandom);
    return std::make_unique<CulledSampler>(table, RandomRanges(reach, options.set_count));
}

}  // namespace lightcull
