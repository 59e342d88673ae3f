#include "lights/culling_tree.h"

#include "lights/memory_size.h"
#include "lights/range_calibration.h"

namespace lightcull {

CullingTree::CullingTree(const LightTable& table, const RandomRanges& ranges)
    : frame_(table.frame),
      tree_(ranged_scene(table).lights, ranges),
      record_of_(table.records.size(), kNoRecord) {
    const std::vector<std::uint32_t>& order = tree_.tree().order;
    for (std::uint32_t record = 0; record < order.size(); ++record) {
        const std::uint32_t light = table.lit[order[record]];
        records_.push_back(table.records[light]);
        lights_.push_back(light);
        record_of_[light] = record;
    }
}

std::size_t CullingTree::memory_size() const noexcept {
    return tree_.memory_size() + size_of(records_) + size_of(lights_) + size_of(record_of_);
}

}  // namespace lightcull
