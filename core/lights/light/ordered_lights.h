#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lights/light/light_record.h"

namespace lightcull {

/// The lit lights of a table, numbered by record: in the order of a tree's leaves.
struct OrderedLights {
    static constexpr std::uint32_t kNoRecord = 0xffffffffu;

    std::vector<LightRecord> records;
    std::vector<std::uint32_t> lights;     ///< the caller's index of a light, by record
    std::vector<std::uint32_t> record_of;  ///< record of a light, by light; kNoRecord for a light
                                           ///< of intensity 0

    /// order: index in table.lit, by record.
    OrderedLights(const LightTable& table, const std::vector<std::uint32_t>& order);

    std::size_t memory_size() const noexcept;
};

}  // namespace lightcull
