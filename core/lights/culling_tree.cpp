#include "lights/culling_tree.h"

#include <tbb/parallel_for.h>

namespace lightcull {

CullingTree::CullingTree(const LightTable& table, float reach, std::uint32_t set_count)
    : frame_(table.frame),
      ranges_(reach, set_count),
      tree_(build_sphere_tree(table, reach)),
      record_of_(table.records.size(), kNoRecord),
      radii_(tree_.slot_count() * set_count) {
    for (std::size_t record = 0; record < tree_.lights.size(); ++record) {
        record_of_[tree_.lights[record]] = static_cast<std::uint32_t>(record);
    }
}

void CullingTree::begin_pass(std::uint64_t pass) {
    ranges_.begin_pass(pass);
    tbb::parallel_for(std::uint32_t{0}, ranges_.set_count(), [&](std::uint32_t set) {
        const auto range_of = [&](std::uint32_t record) {
            return ranges_.range(tree_.records[record].intensity, ranges_.xi(record, set));
        };
        refit_radii(tree_, range_of, radii_.data() + set * tree_.slot_count());
    });
}

}  // namespace lightcull
