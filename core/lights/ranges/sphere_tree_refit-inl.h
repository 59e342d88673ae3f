// Included once per instruction set.
#if defined(LIGHTCULL_SPHERE_TREE_REFIT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef LIGHTCULL_SPHERE_TREE_REFIT_INL
#undef LIGHTCULL_SPHERE_TREE_REFIT_INL
#else
#define LIGHTCULL_SPHERE_TREE_REFIT_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>

#include "lights/ranges/sphere_tree_refit.h"

HWY_BEFORE_NAMESPACE();
namespace lightcull {
namespace HWY_NAMESPACE {
namespace refit {

/// Computes the radii of the nodes [begin, end), whose children are done or among them: for a leaf
/// the light's own radius and its range; for an inner slot the smallest sphere that holds those
/// below it. The compiler makes vectors of the loops over sets.
template <std::size_t kSets>
HWY_ATTR void refit_sets(const Refit& job, std::size_t begin, std::size_t end) {
    constexpr std::size_t kWidth = SphereNode::kWidth;
    // Each step grows by more than the rounding of its sums and distances.
    constexpr float kRoundUp = 1.0f + 1e-6f;
    const SphereTree& tree = job.tree;
    for (std::size_t n = end; n-- > begin;) {
        const SphereNode& node = tree.nodes[n];
        std::array<std::array<float, kSets>, kWidth> slots;
        std::array<float, kSets> largest{};
        for (std::size_t slot = 0; slot < kWidth; ++slot) {
            std::array<float, kSets>& own = slots[slot];
            const std::uint32_t link = node.link[slot];
            if (link == SphereNode::kEmpty) {
                own.fill(kNoRadius);
                continue;
            }
            if ((link & SphereNode::kLeaf) != 0) {
                const std::uint32_t record = link & ~SphereNode::kLeaf;
                const RangedLight& light = tree.records[record];
                job.ranges.ranges(record, job.first_set, light.intensity, own);
                for (float& radius : own) radius += light.radius;
            } else {
                std::copy_n(job.around + link * kSets, kSets, own.begin());
            }
            const float distance =
                length(node.center(static_cast<std::uint32_t>(slot)) - tree.centers[n]);
            for (std::size_t set = 0; set < kSets; ++set) {
                largest[set] = std::max(largest[set], (own[set] + distance) * kRoundUp);
            }
        }
        std::copy_n(largest.begin(), kSets, job.around + n * kSets);
        for (std::size_t set = 0; set < kSets; ++set) {
            float* out = job.radii + set * tree.slot_count() + n * kWidth;
            for (std::size_t slot = 0; slot < kWidth; ++slot) out[slot] = slots[slot][set];
        }
    }
}

HWY_ATTR inline void refit_nodes(const Refit& job, std::size_t begin, std::size_t end) {
    switch (job.set_count) {
        case 1:
            return refit_sets<1>(job, begin, end);
        case 4:
            return refit_sets<4>(job, begin, end);
        default:
            return refit_sets<Refit::kMaxSets>(job, begin, end);
    }
}

}  // namespace refit
}  // namespace HWY_NAMESPACE
}  // namespace lightcull
HWY_AFTER_NAMESPACE();

#endif
