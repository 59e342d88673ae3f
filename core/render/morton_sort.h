#pragma once

#include "base/core_export.h"
#include "render/vec.h"

#include <cstdint>
#include <vector>

namespace lightcull {

/// Sorts `order` along a Morton curve through `positions`, which belong to its elements one by one.
/// `keys` gives room to work in. Equal inputs give equal orders.
LIGHTCULL_CORE_EXPORT void sort_by_morton_code(const std::vector<V3f>& positions,
                                               std::vector<std::uint32_t>& order,
                                               std::vector<std::uint64_t>& keys);

}  // namespace lightcull
