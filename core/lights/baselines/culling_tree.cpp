#include "lights/baselines/culling_tree.h"

#include "lights/calibration/range_calibration.h"

namespace lightcull {

CullingTree::CullingTree(const LightTable& table, const RandomRanges& ranges)
    : frame_(table.frame),
      tree_(ranged_scene(table).lights, ranges),
      lights_(std::make_shared<const OrderedLights>(table, tree_.tree().order)) {
}

CullingTree::CullingTree(const CullingTree& other, std::uint64_t pass)
    : frame_(other.frame_), tree_(other.tree_, pass), lights_(other.lights_) {
}

std::size_t CullingTree::memory_size() const noexcept {
    return tree_.memory_size() + lights_->memory_size();
}

}  // namespace lightcull
