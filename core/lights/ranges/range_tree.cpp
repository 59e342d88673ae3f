#include "lights/ranges/range_tree.h"

#include <algorithm>

#include "base/memory_size.h"
#include "base/parallel_blocks.h"
#include "lights/simd/kernels.h"

namespace lightcull {
namespace {

/// More than there are threads on most machines, so that all of them are kept busy.
constexpr std::uint32_t kRefitParts = 64;

}  // namespace

RangeTree::RangeTree(Span<const RangedLight> lights, const RandomRanges& ranges)
    : ranges_(ranges),
      tree_(build_sphere_tree(lights, ranges.reach())),
      refit_order_(make_refit_order(tree_, kRefitParts)),
      radii_(tree_.slot_count() * ranges.set_count()),
      around_(tree_.nodes.size() * std::min(ranges.set_count(), Refit::kMaxSets)) {
}

void RangeTree::begin_pass(std::uint64_t pass) {
    ranges_.begin_pass(pass);
    const std::uint32_t sets = ranges_.set_count(), together = std::min(sets, Refit::kMaxSets);
    for (std::uint32_t set = 0; set < sets; set += together) refit(set, together);
}

void RangeTree::refit(std::uint32_t first_set, std::uint32_t set_count) {
    const Refit job{tree_,
                    ranges_,
                    first_set,
                    set_count,
                    radii_.data() + first_set * tree_.slot_count(),
                    around_.data()};
    const auto refit_nodes = kernels().refit_nodes;
    const std::vector<RefitOrder::Part>& parts = refit_order_.side_by_side;
    for_each_block(parts.size(), 1, [&](std::size_t i, std::size_t) {
        refit_nodes(job, parts[i].begin, parts[i].end);
    });
    for (const RefitOrder::Part& part : refit_order_.afterwards) {
        refit_nodes(job, part.begin, part.end);
    }
}

std::size_t RangeTree::memory_size() const noexcept {
    return tree_.memory_size() + size_of(radii_) + size_of(around_);
}

}  // namespace lightcull
