#include "render/morton_sort.h"

#include "base/morton.h"
#include "base/radix_sort.h"

#include <ImathBox.h>

namespace lightcull {

void sort_by_morton_code(const std::vector<V3f>& positions, std::vector<std::uint32_t>& order,
                         std::vector<std::uint64_t>& keys) {
    Imath::Box3f bounds;
    for (const V3f& p : positions) bounds.extendBy(p);
    if (bounds.isEmpty()) return;
    const V3f size = bounds.size();
    const auto scale = [](float extent) { return extent > 0.0f ? 1023.0f / extent : 0.0f; };
    const V3f cells(scale(size.x), scale(size.y), scale(size.z));

    keys.resize(2 * positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const V3f p = (positions[i] - bounds.min) * cells;
        const std::uint32_t code =
            morton_code(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y),
                        static_cast<std::uint32_t>(p.z));
        keys[i] = std::uint64_t{code} << 32 | order[i];
    }
    const std::uint64_t* const sorted =
        sort_keys<3>(keys.data(), keys.data() + positions.size(), positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        order[i] = static_cast<std::uint32_t>(sorted[i]);
    }
}

}  // namespace lightcull
