#include <lightcull/error.h>
#include <lightcull/sampler_info.h>

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/parallel_blocks.h"
#include "base/refine.h"
#include "base/reservoir.h"
#include "lights/bvh/light_bvh_kernels.h"
#include "lights/calibration/range_calibration.h"
#include "lights/glossy/directed_calibration.h"
#include "lights/glossy/directed_culled_sampler.h"
#include "lights/groups/group_calibration.h"
#include "lights/groups/group_kernels.h"
#include "lights/groups/narrow_cones.h"
#include "lights/ranges/set_count.h"
#include "lights/samplers/culled_scene.h"
#include "lights/samplers/make_samplers.h"
#include "lights/samplers/point_order.h"

namespace lightcull {
namespace {

/// Sets of lights with glossy points among them have spheres of their own, not radii alone: 55
/// bytes a light and set.
constexpr std::uint32_t kSetsOfGlossy = 16;

/// Every accepted group of lights is weighed by g / p while the tree is walked, and one is kept;
/// its light is then found down a light BVH. The mean over xi of [i accepted] (g_i / p_i) / W /
/// prob is 1 for prob = g_i / W.
///
/// Where no group is accepted, the light BVH chooses among all lights, so that a point that few
/// ranges cover, or only those of dim lights, is not left in the dark. Given the ranges of all
/// others, a group that is accepted alone is chosen with p + (1 - p) q, where q is what the BVH
/// gives it: that is prob then, whichever way it was chosen.
class CulledSampler final : public CulledSamplerBase, public SamplerInfo {
  public:
    CulledSampler(const Frame& frame, LightGroups groups, const RandomRanges& ranges,
                  std::uint32_t group_size)
        : frame_(frame),
          tree_(groups.ranged(), ranges),
          group_size_(group_size),
          built_looseness_(looseness(groups.bvh)) {
        groups.reorder(tree_.tree().order);
        groups_ = std::make_shared<const LightGroups>(std::move(groups));
    }

    CulledSampler(const CulledSampler& other, std::uint64_t pass)
        : frame_(other.frame_),
          groups_(other.groups_),
          tree_(other.tree_, pass),
          group_size_(other.group_size_),
          built_looseness_(other.built_looseness_) {}

    CulledScene scene() const noexcept override { return {frame_, *groups_, tree_}; }

    std::shared_ptr<const LightGroups> groups() const noexcept override { return groups_; }

    void begin_pass(std::uint64_t pass) override { tree_.begin_pass(pass); }

    std::unique_ptr<const LightSelector> pass(std::uint64_t number) const override {
        return std::make_unique<CulledSampler>(*this, number);
    }

    LightUpdate update(Span<const Light> lights, float max_growth) override {
        const LightTable table = make_updated_light_table(lights, groups_->group_of.size());
        if (table.has_glossy) {
            throw Error("update: a light became a glossy point, which wants another sampler");
        }
        const RandomRanges ranges(reach_in(table.frame, tree_.ranges().reach(), frame_),
                                  set_count());
        LightUpdate result;
        result.rebuilt = !holds_all_lit(groups_->bvh, table);
        if (!result.rebuilt) {
            LightGroups groups = *groups_;
            refit_light_groups(groups, table);
            result.growth = growth(looseness(groups.bvh), built_looseness_);
            result.rebuilt = result.growth > max_growth;
            if (!result.rebuilt) {
                const std::vector<RangedLight> ranged = groups.ranged();
                auto updated = std::make_shared<const LightGroups>(std::move(groups));
                tree_.update(ranged, ranges);  // what throws comes before what changes
                groups_ = std::move(updated);
                frame_ = table.frame;
            }
        }
        if (result.rebuilt) {
            *this = CulledSampler(table.frame, make_light_groups(table, group_size_), ranges,
                                  group_size_);
        }
        return result;
    }

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        const Receiver x = to_local(point);
        GroupChoice choice;
        tree_.for_accepted(x, point.set, [&](Span<const std::uint32_t> records) {
            group_kernels().weigh(tree_, groups_->groups.data(), records, x, float_bits(u), choice);
        });
        LightBvhDescent descent;
        descent.receiver = x;
        start(choice, u, descent);
        light_bvh_kernels<MeansNode>().descend(groups_->bvh, {&descent, 1});
        return result(descent, receipt_of(point.set, choice, x));
    }

    /// Selects for sixteen points at a time, of one set and near each other.
    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override {
        const std::vector<std::uint32_t> order = order_points(points, set_count());
        constexpr std::size_t kBlock = 16 * ReceiverPacket::kSize;
        for_each_block(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            while (begin < end) {
                begin += select_some({order.data() + begin, end - begin}, points, u, selections);
            }
        });
    }

    /// The probability of the group is g / W', with W' = W if it was accepted, else W + w
    /// (design.md, "MIS"), unless no other was accepted; it is multiplied by that of the light
    /// within the group.
    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t light) const noexcept override {
        const std::uint32_t index = groups_->group_of[light];
        if (index == LightGroups::kNoGroup) return 0.0f;
        const LightGroup& group = groups_->groups[index];
        const Receiver x = to_local(point);
        const float g = importance(group, x);
        const Approach way = approach(x.position, group.position());
        const bool accepted = g > 0.0f && tree_.accepts(index, receipt.key, way);
        if (receipt.weight_sum == 0.0f || (accepted && is_alone(receipt))) {
            return prob_without_others(x, index, light);
        }
        if (!(g > 0.0f)) return 0.0f;
        const float sum = accepted
                              ? receipt.weight_sum
                              : std::abs(receipt.weight_sum) + g * tree_.inverse_prob(index, way);
        return prob_of_light(x, index, light, static_cast<double>(g / sum));
    }

    std::uint32_t set_count() const noexcept override { return tree_.ranges().set_count(); }

    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        const Receiver x = to_local(point);
        SelectionCounts counts;
        counts.nodes_visited =
            tree_.for_accepted(x, point.set, [&](Span<const std::uint32_t> records) {
                for (const std::uint32_t record : records) {
                    ++counts.lights_tested;
                    counts.accepted += importance(groups_->groups[record], x) > 0.0f ? 1 : 0;
                }
            });
        return counts;
    }

    std::size_t memory_size() const noexcept override {
        return groups_->memory_size() + tree_.memory_size();
    }

  private:
    Receiver to_local(const ShadingPoint& point) const noexcept { return {frame_, point}; }

    static bool is_alone(const Receipt& receipt) noexcept { return receipt.weight_sum < 0.0f; }

    /// The probability of a light in a group of that probability.
    float prob_of_light(const Receiver& x, std::uint32_t index, std::uint32_t light,
                        double prob_of_group) const noexcept {
        return static_cast<float>(light_bvh_kernels<MeansNode>().prob_of_slot(
            groups_->bvh, x, groups_->bvh.slots[light], groups_->slots[index], prob_of_group));
    }

    /// The probability of a light where no group is accepted, or its own alone.
    float prob_without_others(const Receiver& x, std::uint32_t index,
                              std::uint32_t light) const noexcept {
        const LightGroup& group = groups_->groups[index];
        const Approach way = approach(x.position, group.position());
        double p = 0.0;
        if (importance(group, x) > 0.0f) {
            p = 1.0 / static_cast<double>(tree_.inverse_prob(index, way));
        }
        const double q = light_bvh_kernels<MeansNode>().prob_of_slot(
            groups_->bvh, x, groups_->slots[index], LightBvh<MeansNode>::kNoSlot, 1.0);
        return prob_of_light(x, index, light, p + (1.0 - p) * q);
    }

    /// Puts a descent at the top of the group that was chosen, or of all if none was.
    void start(const GroupChoice& choice, float u, LightBvhDescent& descent) const noexcept {
        if (choice.weight_sum > 0.0f) {
            descent.place = uniform_double(hash(float_bits(u), choice.record));
            descent.prob = static_cast<double>(choice.numerator / choice.weight_sum);
            descent.child = groups_->groups[choice.record].child[0];
        } else if (!groups_->bvh.nodes.empty()) {
            descent.place = uniform_double(hash(float_bits(u), LightGroups::kNoGroup));
            descent.prob = 1.0;
            descent.child = 0;
        } else {
            descent.prob = 0.0;
            descent.child = LightBvhNode::kLight;
        }
    }

    /// The receipt of a choice. The weight of a group that was accepted alone is negative in it,
    /// unless its p is 1, which makes no difference.
    Receipt receipt_of(std::uint32_t set, const GroupChoice& choice,
                       const Receiver& x) const noexcept {
        const bool alone = may_be_alone(choice, x) && accepted_count(x, set) == 1;
        return {alone ? -choice.weight_sum : choice.weight_sum, set};
    }

    /// True if the weight of the chosen group is the sum of all. Others may have been accepted and
    /// yet be too light to change it.
    bool may_be_alone(const GroupChoice& choice, const Receiver& x) const noexcept {
        const float g = choice.numerator, sum = choice.weight_sum;
        if (!(g < sum)) return false;
        const LightGroup& group = groups_->groups[choice.record];
        const Approach way = approach(x.position, group.position());
        // First a bound on the weight, which is cheap.
        constexpr float kRoundUp = 1.0f + 1e-5f;
        const float limit = tree_.ranges().limit(group.intensity[0]);
        if (sum * limit > g * way.distance2 * kRoundUp) return false;
        return g * tree_.inverse_prob(choice.record, way) == sum;
    }

    std::uint32_t accepted_count(const Receiver& x, std::uint32_t set) const noexcept {
        std::uint32_t count = 0;
        tree_.for_accepted(x, set, [&](Span<const std::uint32_t> records) {
            for (const std::uint32_t record : records) {
                count += importance(groups_->groups[record], x) > 0.0f ? 1 : 0;
            }
        });
        return count;
    }

    Selection result(const LightBvhDescent& descent, const Receipt& receipt) const noexcept {
        if (!(descent.prob > 0.0)) return {0, 0.0f, 0.0f, receipt};
        const std::uint32_t light = descent.child & ~LightBvhNode::kLight;
        const float prob =
            receipt.weight_sum > 0.0f
                ? static_cast<float>(descent.prob)
                : prob_without_others(descent.receiver, groups_->group_of[light], light);
        return {light, prob, prob, receipt};
    }

    /// Puts as many of the points that `order` names, one at least, as fit into one packet, selects
    /// for them, and returns their number.
    std::size_t select_some(Span<const std::uint32_t> order, Span<const ShadingPoint> points,
                            Span<const float> u, Span<Selection> selections) const noexcept {
        const std::uint32_t set = points[order[0]].set;
        ReceiverPacket receivers(set);
        PacketRandom random;
        std::array<LightBvhDescent, ReceiverPacket::kSize> descents;
        std::size_t count = 0;
        do {
            const std::uint32_t i = order[count];
            descents[count].receiver = to_local(points[i]);
            receivers.put(count, descents[count].receiver);
            random.u_bits[count++] = float_bits(u[i]);
        } while (count < std::min(order.size(), ReceiverPacket::kSize) &&
                 points[order[count]].set == set);
        // The first point is repeated to fill the packet.
        for (std::size_t i = count; i < ReceiverPacket::kSize; ++i) {
            receivers.put(i, descents[0].receiver);
            random.u_bits[i] = random.u_bits[0];
        }
        const std::size_t next = std::min(order.size() - count, ReceiverPacket::kSize);
        prefetch({order.data() + count, next}, points, u, selections);
        PacketChoice packet{};
        group_kernels().select_packet(tree_, groups_->groups.data(), receivers, random, packet);
        std::array<Receipt, ReceiverPacket::kSize> receipts;
        for (std::size_t i = 0; i < count; ++i) {
            const GroupChoice choice{packet.weight_sum[i], packet.numerator[i], packet.record[i]};
            receipts[i] = receipt_of(set, choice, descents[i].receiver);
            start(choice, u[order[i]], descents[i]);
        }
        light_bvh_kernels<MeansNode>().descend(groups_->bvh, {descents.data(), count});
        for (std::size_t i = 0; i < count; ++i) {
            selections[order[i]] = result(descents[i], receipts[i]);
        }
        return count;
    }

    /// Prefetches, for the points of the next packet, the memory that it will read and write.
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
    std::shared_ptr<const LightGroups> groups_;
    RangeTree tree_;
    std::uint32_t group_size_;
    double built_looseness_;  ///< looseness of the BVH, when it was last built
};

}  // namespace

std::unique_ptr<LightSampler> make_culled_sampler(const CulledOptions& options,
                                                  Span<const Light> lights,
                                                  const SamplerContext& context) {
    const LightTable table = make_light_table(lights);
    if (table.has_glossy) {
        if (options.group_size.value_or(1) != 1) {
            throw Error("group is " + std::to_string(*options.group_size) +
                        ", and there are glossy points, which do not share ranges");
        }
        const float reach = calibrate_reach(directed_scene(table), options.range,
                                            context.calibration_points, RangeLaw::kRandom);
        return make_directed_culled_sampler(table, reach,
                                            options.set_count.value_or(kSetsOfGlossy));
    }
    // Such cones are weighed one by one.
    constexpr float kNarrow = 1.05f;
    const std::uint32_t suitable_size = share_of_narrow_cones(lights, kNarrow) > kManyNarrowCones
                                            ? 1
                                            : suitable_group_size(table.lit.size());
    const std::uint32_t group_size = options.group_size.value_or(suitable_size);
    LightGroups groups = make_light_groups(table, group_size);
    // So few are weighed in less time than it takes to find out which.
    constexpr float kFew = 4.0f;
    const bool all = !options.range.error_bound && static_cast<float>(groups.groups.size()) <=
                                                       kFew * options.range.expected_accepted;
    const float found = calibrate_reach(ranged_scene(groups, table.frame), options.range,
                                        context.calibration_points, RangeLaw::kRandom);
    const float reach = all ? kGreatestReach : found;
    const std::uint32_t suitable =
        suitable_set_count(lights.size(), groups.groups.size(), context.points_per_pass);
    return std::make_unique<CulledSampler>(
        table.frame, std::move(groups), RandomRanges(reach, options.set_count.value_or(suitable)),
        group_size);
}

}  // namespace lightcull
