#pragma once

#include <lightcull/light_sampler.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/random.h"
#include "base/refine.h"
#include "base/reservoir.h"
#include "base/scramble.h"
#include "lights/bvh/light_bvh_kernels.h"
#include "lights/samplers/culled_scene.h"

namespace lightcull::testing {

/// Replays a selection of `culled`, and says whether one of its decisions was so close that another
/// rounding of divisions and roots, which Vulkan leaves to the device, would turn it.
class CloseCall {
  public:
    CloseCall(const CulledScene& scene, const ShadingPoint& point, float u)
        : scene_(scene), x_(scene.frame, point) {
        const std::uint32_t group = choose_group(point.set, float_bits(u));
        place_ = uniform_double(hash(float_bits(u), group));
        std::uint32_t child =
            group == LightGroups::kNoGroup ? 0 : scene.groups.groups[group].child[0];
        while ((child & LightBvhNode::kLight) == 0) child = step_down(child);
    }

    bool is_close() const noexcept { return is_close_; }

  private:
    static constexpr double kRounding = 2e-6;

    /// The group that is chosen; kNoGroup if none is accepted.
    std::uint32_t choose_group(std::uint32_t set, std::uint32_t u_bits) {
        std::uint32_t chosen = LightGroups::kNoGroup;
        float sum = 0.0f;
        const auto weigh = [&](std::uint32_t record) {
            const LightGroup& group = scene_.groups.groups[record];
            const float g = importance(group, x_);
            if (!(g > 0.0f)) return;
            const Approach way = approach(x_.position, group.position());
            const float weight = g * scene_.tree.inverse_prob(record, way);
            sum += weight;
            const std::uint32_t bits = scramble(u_bits ^ (record * Reservoir::kStride));
            const float random =
                std::min(static_cast<float>(bits) * 0x1p-32f, Reservoir::kBelowOne);
            compare(random * sum, weight, weight);
            if (random * sum < weight) chosen = record;
        };
        scene_.tree.for_accepted(x_, set, [&](Span<const std::uint32_t> records) {
            for (const std::uint32_t record : records) weigh(record);
        });
        return chosen;
    }

    std::uint32_t step_down(std::uint32_t node) {
        LightBvhImportances g;
        light_bvh_kernels<MeansNode>().importances(scene_.groups.bvh.nodes[node], x_, g.of);
        double sums[LightBvhNode::kWidth + 1] = {};
        for (int i = 0; i < LightBvhNode::kWidth; ++i) {
            sums[i + 1] = sums[i] + static_cast<double>(g.of[i]);
        }
        const double total = sums[LightBvhNode::kWidth], target = place_ * total;
        if (!(total > 0.0)) return LightBvhNode::kLight;
        int chosen = 0;
        for (int i = 1; i < LightBvhNode::kWidth; ++i) {
            compare(sums[i], target, total);
            chosen += sums[i] <= target ? 1 : 0;
        }
        place_ = (target - sums[chosen]) / static_cast<double>(g.of[chosen]);
        return scene_.groups.bvh.nodes[node].child[chosen];
    }

    template <typename Number>
    void compare(Number a, Number b, Number scale) noexcept {
        is_close_ |= std::abs(static_cast<double>(a - b)) <= kRounding * static_cast<double>(scale);
    }

    CulledScene scene_;
    Receiver x_;
    double place_ = 0.0;
    bool is_close_ = false;
};

}  // namespace lightcull::testing
