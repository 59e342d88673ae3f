#include "lights/light/ordered_lights.h"

#include "base/memory_size.h"

namespace lightcull {

OrderedLights::OrderedLights(const LightTable& table, const std::vector<std::uint32_t>& order)
    : record_of(table.records.size(), kNoRecord) {
    records.reserve(order.size());
    lights.reserve(order.size());
    for (const std::uint32_t lit : order) {
        const std::uint32_t light = table.lit[lit];
        record_of[light] = static_cast<std::uint32_t>(records.size());
        records.push_back(table.records[light]);
        lights.push_back(light);
    }
}

std::size_t OrderedLights::memory_size() const noexcept {
    return size_of(records) + size_of(lights) + size_of(record_of);
}

}  // namespace lightcull
