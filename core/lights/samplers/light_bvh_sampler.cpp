#include <algorithm>
#include <array>

#include "base/memory_size.h"
#include "base/parallel_blocks.h"
#include "base/refine.h"
#include "lights/bvh/light_bvh.h"
#include "lights/bvh/light_bvh_descend.h"
#include "lights/bvh/light_bvh_kernels.h"
#include "lights/samplers/make_samplers.h"
#include "lights/samplers/passless_sampler.h"

namespace lightcull {
namespace {

template <typename Node>
class LightBvhSampler final : public PasslessSampler<LightBvhSampler<Node>> {
  public:
    explicit LightBvhSampler(const LightTable& table)
        : frame_(table.frame),
          bvh_(std::make_shared<const LightBvh<Node>>(build_light_bvh<Node>(table))),
          built_looseness_(looseness(*bvh_)) {}

    Selection select(const ShadingPoint& point, float u) const noexcept override {
        if (bvh_->nodes.empty()) return {};
        LightBvhDescent descent{to_local(point), refine(u, point)};
        light_bvh_kernels<Node>().descend(*bvh_, {&descent, 1});
        return result(descent);
    }

    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override {
        if (bvh_->nodes.empty()) {
            std::fill(selections.begin(), selections.end(), Selection{});
            return;
        }
        constexpr std::size_t kBlock = 16 * kMaxDescents;
        for_each_block(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            for (; begin < end; begin += kMaxDescents) {
                const std::size_t count = std::min(end - begin, kMaxDescents);
                select_some({points.data() + begin, count}, u.data() + begin,
                            selections.data() + begin);
            }
        });
    }

    float prob(const ShadingPoint& point, const Receipt&,
               std::uint32_t light) const noexcept override {
        const LightBvhSlot slot = bvh_->slots[light];
        if (slot == kNoSlot) return 0.0f;
        return static_cast<float>(
            light_bvh_kernels<Node>().prob_of_slot(*bvh_, to_local(point), slot, kNoSlot, 1.0));
    }
    bool needs_receipt() const noexcept override { return false; }

    LightUpdate update(Span<const Light> lights, float max_growth) override {
        const LightTable table = make_updated_light_table(lights, bvh_->slots.size());
        LightUpdate result;
        result.rebuilt = !holds_all_lit(*bvh_, table);
        if (!result.rebuilt) {
            LightBvh<Node> bvh = *bvh_;
            refit_light_bvh(bvh, table);
            result.growth = growth(looseness(bvh), built_looseness_);
            result.rebuilt = result.growth > max_growth;
            if (!result.rebuilt) {
                bvh_ = std::make_shared<const LightBvh<Node>>(std::move(bvh));
                frame_ = table.frame;
            }
        }
        if (result.rebuilt) *this = LightBvhSampler(table);
        return result;
    }

    /// Counts the work of the selection with u = 0.5. All children of the nodes on its way are
    /// tested; the children that are lights and have an importance above 0 are accepted.
    SelectionCounts count(const ShadingPoint& point) const noexcept override {
        SelectionCounts counts;
        if (bvh_->nodes.empty()) return counts;
        LightBvhDescent descent{to_local(point), refine(0.5f, point)};
        light_bvh_kernels<Node>().descend(*bvh_, {&descent, 1});
        const std::uint32_t last = descent.prob > 0.0
                                       ? bvh_->slots[result(descent).light] / LightBvhNode::kWidth
                                       : descent.child;
        for (std::uint32_t node = last;; node = bvh_->parents[node] / LightBvhNode::kWidth) {
            add(bvh_->nodes[node], descent.receiver, counts);
            if (node == 0) return counts;
        }
    }

    std::size_t memory_size() const noexcept override {
        return size_of(bvh_->nodes) + size_of(bvh_->parents) + size_of(bvh_->slots);
    }

  private:
    static constexpr LightBvhSlot kNoSlot = LightBvh<Node>::kNoSlot;

    /// Selects for at most kMaxDescents points, in turn, so that one waits for memory while others
    /// compute.
    void select_some(Span<const ShadingPoint> points, const float* u,
                     Selection* selections) const noexcept {
        std::array<LightBvhDescent, kMaxDescents> descents;
        for (std::size_t i = 0; i < points.size(); ++i) {
            descents[i] = {to_local(points[i]), refine(u[i], points[i])};
        }
        light_bvh_kernels<Node>().descend(*bvh_, {descents.data(), points.size()});
        for (std::size_t i = 0; i < points.size(); ++i) selections[i] = result(descents[i]);
    }

    Receiver to_local(const ShadingPoint& point) const noexcept { return Receiver(frame_, point); }

    static void add(const Node& node, const Receiver& receiver, SelectionCounts& counts) noexcept {
        ++counts.nodes_visited;
        LightBvhImportances all;
        light_bvh_kernels<Node>().importances(node, receiver, all.of);
        for (std::size_t i = 0; i < LightBvhNode::kWidth; ++i) {
            if (node.child[i] == LightBvhNode::kEmpty) continue;
            ++counts.lights_tested;
            const bool is_light = (node.child[i] & LightBvhNode::kLight) != 0;
            if (is_light && all.of[i] > 0.0f) ++counts.accepted;
        }
    }

    static Selection result(const LightBvhDescent& descent) noexcept {
        if (!(descent.prob > 0.0)) return {};
        const auto prob = static_cast<float>(descent.prob);
        return {descent.child & ~LightBvhNode::kLight, prob, prob, {}};
    }

    Frame frame_;
    std::shared_ptr<const LightBvh<Node>> bvh_;
    double built_looseness_;
};

}  // namespace

std::unique_ptr<LightSampler> make_light_bvh_sampler(const LightBvhOptions& options,
                                                     Span<const Light> lights) {
    const LightTable table = make_light_table(lights);
    if (options.importance == ClusterImportance::kMeans) {
        return std::make_unique<LightBvhSampler<MeansNode>>(table);
    }
    return std::make_unique<LightBvhSampler<BoundsNode>>(table);
}

}  // namespace lightcull
