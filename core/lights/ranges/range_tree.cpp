#include "lights/ranges/range_tree.h"

#include <algorithm>
#include <cassert>

#include "base/memory_size.h"
#include "base/parallel_blocks.h"
#include "lights/ranges/range_kernels.h"

namespace lightcull {
namespace {

/// The number of parts of a refit: more than there are threads on most machines, so that all of
/// them are kept busy.
constexpr std::uint32_t kRefitParts = 64;

}  // namespace

RangeTree::RangeTree(Span<const RangedLight> lights, const RandomRanges& ranges)
    : ranges_(ranges),
      topology_([&] {
          Topology topology{build_sphere_tree(lights, ranges.reach()), {}};
          topology.refit_order = make_refit_order(topology.tree, kRefitParts);
          return std::make_shared<const Topology>(std::move(topology));
      }()),
      radii_(tree().slot_count() * ranges.set_count()) {
}

RangeTree::RangeTree(const RangeTree& other, std::uint64_t pass)
    : ranges_(other.ranges_), topology_(other.topology_), radii_(other.radii_.size()) {
    begin_pass(pass);
}

void RangeTree::update(Span<const RangedLight> records, const RandomRanges& ranges) {
    assert(ranges.set_count() == ranges_.set_count());
    topology_ = std::make_shared<const Topology>(Topology{
        refit_sphere_tree(tree(), records, ranges.reach()), topology_->refit_order});
    ranges_ = ranges;
}

void RangeTree::begin_pass(std::uint64_t pass) {
    const std::uint32_t sets = ranges_.set_count(), together = std::min(sets, Refit::kMaxSets);
    std::vector<float> around(tree().nodes.size() * together);  // allocated before anything is
                                                                // changed
    ranges_.begin_pass(pass);
    for (std::uint32_t set = 0; set < sets; set += together) refit(set, together, around.data());
}

void RangeTree::refit(std::uint32_t first_set, std::uint32_t set_count, float* around) {
    const Refit job{
        tree(), ranges_, first_set, set_count, radii_.data() + first_set * tree().slot_count(),
        around};
    const auto refit_nodes = range_kernels().refit_nodes;
    const std::vector<RefitOrder::Part>& parts = topology_->refit_order.side_by_side;
    for_each_block(parts.size(), 1, [&](std::size_t i, std::size_t) {
        refit_nodes(job, parts[i].begin, parts[i].end);
    });
    for (const RefitOrder::Part& part : topology_->refit_order.afterwards) {
        refit_nodes(job, part.begin, part.end);
    }
}

std::size_t RangeTree::memory_size() const noexcept {
    return tree().memory_size() + size_of(radii_);
}

}  // namespace lightcull
