#include <lightcull/error.h>
#include <lightcull/samplers.h>

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <vector>

#include "lights/kernels.h"
#include "lights/light_groups.h"
#include "lights/parallel_blocks.h"
#include "lights/point_order.h"
#include "lights/range_calibration.h"
#include "lights/range_tree.h"
#include "lights/reservoir.h"
#include "lights/set_count.h"

namespace lightcull {
namespace {

/// Every accepted group of lights is weighed by g / p while the tree is walked, and one is kept;
/// its light is then found down a light BVH. The mean over xi of [i accepted] (g_i / p_i) / W /
/// prob is 1 for prob = g_i / W.
class CulledSampler final : public LightSampler {
  public:
    CulledSampler(const Frame& frame, LightGroups groups, const RandomRanges& ranges)
        : frame_(frame), groups_(std::move(groups)), tree_(groups_.ranged(), ranges) {
        groups_.reorder(tree_.tree().order);
    }

    void begin_pass(std::uint64_t pass) override { tree_.begin_pass(pass); }

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        const LightBvhPoint x = to_local(point);
        GroupChoice choice;
        tree_.for_accepted(x, point.set, [&](Span<const std::uint32_t> records) {
            kernels().weigh_groups(tree_, groups_.groups.data(), records, x, float_bits(u), choice);
        });
        LightBvhDescent descent;
        descent.point = x;
        start(choice, u, descent);
        kernels().means.descend(groups_.bvh, {&descent, 1});
        return result(descent, {choice.weight_sum, point.set});
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

    /// Of the group g / W', with W' = W if it was accepted, else W + w (DESIGN section 3, MIS);
    /// times that of the light within it.
    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        const std::uint32_t index = groups_.group_of[light];
        if (index == LightGroups::kNoGroup) return 0.0f;
        const LightGroup& group = groups_.groups[index];
        const LightBvhPoint x = to_local(point);
        const float g = importance(group, x);
        if (!(g > 0.0f)) return 0.0f;
        const Approach way = approach(x.position, group.position());
        const float sum = tree_.accepts(index, receipt.key, way)
                              ? receipt.weight_sum
                              : receipt.weight_sum + g * tree_.inverse_prob(index, way);
        const bool alone = (group.child[0] & LightBvhNode::kLight) != 0;
        if (alone) return g / sum;
        const double prob_of_group = static_cast<double>(g / sum);
        return static_cast<float>(
            kernels().means.prob_of_light(groups_.bvh, x, light, prob_of_group));
    }

    std::uint32_t set_count() const noexcept override { return tree_.ranges().set_count(); }

    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        const LightBvhPoint x = to_local(point);
        SelectionCounts counts;
        counts.nodes_visited =
            tree_.for_accepted(x, point.set, [&](Span<const std::uint32_t> records) {
                for (const std::uint32_t record : records) {
                    ++counts.lights_tested;
                    counts.accepted += importance(groups_.groups[record], x) > 0.0f ? 1 : 0;
                }
            });
        return counts;
    }

    std::size_t memory_size() const noexcept override {
        return groups_.memory_size() + tree_.memory_size();
    }

  private:
    LightBvhPoint to_local(const ShadingPoint& point) const noexcept {
        return {frame_.position(point.position), Receiver(point)};
    }

    /// Puts a descent at the top of the group that was chosen, or at its end if none was.
    void start(const GroupChoice& choice, float u, LightBvhDescent& descent) const noexcept {
        if (choice.weight_sum > 0.0f) {
            descent.place = uniform_double(hash(float_bits(u), choice.record));
            descent.prob = static_cast<double>(choice.numerator / choice.weight_sum);
            descent.child = groups_.groups[choice.record].child[0];
        } else {
            descent.prob = 0.0;
            descent.child = LightBvhNode::kLight;
        }
    }

    static Selection result(const LightBvhDescent& descent, const Receipt& receipt) noexcept {
        if (!(descent.prob > 0.0)) return {0, 0.0f, receipt};
        return {descent.child & ~LightBvhNode::kLight, static_cast<float>(descent.prob), receipt};
    }

    /// As many of the points that `order` names as go into one packet; their number.
    std::size_t select_some(Span<const std::uint32_t> order, Span<const ShadingPoint> points,
                            Span<const float> u, Span<Selection> selections) const noexcept {
        const std::uint32_t set = points[order[0]].set;
        PacketBuilder builder(set);
        std::array<LightBvhDescent, PointPacket::kSize> descents;
        std::size_t count = 0;
        while (count < std::min(order.size(), PointPacket::kSize) &&
               points[order[count]].set == set) {
            const std::uint32_t i = order[count];
            descents[count].point = to_local(points[i]);
            builder.add(descents[count++].point, u[i]);
        }
        while (builder.size() < PointPacket::kSize) {
            builder.add(descents[0].point, u[order[0]]);  // to fill it
        }
        const std::size_t next = std::min(order.size() - count, PointPacket::kSize);
        prefetch({order.data() + count, next}, points, u, selections);
        PacketChoice packet{};
        kernels().select_packet(tree_, groups_.groups.data(), builder.packet(), packet);
        for (std::size_t i = 0; i < count; ++i) {
            start({packet.weight_sum[i], packet.numerator[i], packet.record[i]}, u[order[i]],
                  descents[i]);
        }
        kernels().means.descend(groups_.bvh, {descents.data(), count});
        for (std::size_t i = 0; i < count; ++i) {
            selections[order[i]] = result(descents[i], {packet.weight_sum[i], set});
        }
        return count;
    }

    /// Of the points of the next packet what this one will read and write.
    static void prefetch(Span<const std::uint32_t> order, Span<const ShadingPoint> points,
                         Span<const float> u, Span<Selection> selections) noexcept {
        for (const std::uint32_t i : order) {
            hwy::Prefetch(&points[i]);
            hwy::Prefetch(&points[i].lobe.peak);
            hwy::Prefetch(&u[i]);
            hwy::Prefetch(&selections[i]);
        }
    }

    Frame frame_;
    LightGroups groups_;
    RangeTree tree_;
};

}  // namespace

std::unique_ptr<LightSampler> make_culled_sampler(Span<const Light> lights,
                                                  const CulledOptions& options) {
    check_set_count(options.set_count);
    if (options.group_size == 0u) throw Error("group is 0, wanted 1 or more");
    const LightTable table = make_light_table(lights);
    LightGroups groups = make_light_groups(
        table, options.group_size.value_or(suitable_group_size(table.lit.size())));
    const float reach =
        calibrate_reach(ranged_scene(groups, table.frame), options.range, RangeLaw::kRandom);
    return std::make_unique<CulledSampler>(table.frame, std::move(groups),
                                           RandomRanges(reach, options.set_count));
}

}  // namespace lightcull
