#include "lights/culling_tree.h"

#include <tbb/parallel_for.h>

#include "lights/sphere_tree_refit.h"

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
    constexpr std::uint32_t kTogether = 16;
    const std::uint32_t sets = ranges_.set_count();
    if (sets < kTogether) {
        for (std::uint32_t set = 0; set < sets; ++set) refit<1>(set);
    } else {
        tbb::parallel_for(std::uint32_t{0}, sets / kTogether,
                          [&](std::uint32_t block) { refit<kTogether>(block * kTogether); });
    }
}

template <std::size_t kSets>
void CullingTree::refit(std::uint32_t first_set) {
    const auto ranges_of = [&](std::uint32_t record, std::array<float, kSets>& out) {
        ranges_.ranges(record, first_set, tree_.records[record].intensity, out);
    };
    refit_radii<kSets>(tree_, ranges_of, radii_.data() + first_set * tree_.slot_count());
}

}  // namespace lightcull
