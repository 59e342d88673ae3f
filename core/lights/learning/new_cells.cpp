#include "lights/learning/new_cells.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace lightcull {

void NewCells::add(const CellLattice& lattice, CellKey key, const float3& position,
                   const float3& normal) noexcept {
    Entry* const entry = entry_of(key);
    if (entry == nullptr) return;
    const float3 corner = lattice.corner(key);
    const float inverse = 1.0f / lattice.edge(CellLattice::level_of(key));
    const auto part = [](float x) {
        return static_cast<std::int64_t>(std::clamp(x, -1.0f, 2.0f) * MetCell::kParts);
    };
    const std::int64_t numbers[6] = {part((position.x - corner.x) * inverse),
                                     part((position.y - corner.y) * inverse),
                                     part((position.z - corner.z) * inverse),
                                     part(normal.x),
                                     part(normal.y),
                                     part(normal.z)};
    entry->count.fetch_add(1, std::memory_order_relaxed);
    for (std::size_t i = 0; i < 6; ++i) {
        entry->sums[i].fetch_add(numbers[i], std::memory_order_relaxed);
    }
}

NewCells::Entry* NewCells::entry_of(CellKey key) noexcept {
    std::size_t at = mix(key) & (kSlots - 1);
    while (true) {
        Entry& entry = entries_[at];
        CellKey found = entry.key.load(std::memory_order_relaxed);
        if (found == key) return &entry;
        if (found == kEmpty) {
            if (full()) return nullptr;
            if (entry.key.compare_exchange_strong(found, key, std::memory_order_relaxed)) {
                count_.fetch_add(1, std::memory_order_relaxed);
                return &entry;
            }
            if (found == key) return &entry;
        }
        at = (at + 1) & (kSlots - 1);
    }
}

std::vector<MetCell> NewCells::cells() const {
    std::vector<MetCell> cells;
    for (std::size_t i = 0; i < kSlots; ++i) {
        const Entry& entry = entries_[i];
        if (entry.key == kEmpty) continue;
        MetCell cell{entry.key, entry.count, {}, {}};
        for (std::size_t k = 0; k < 3; ++k) {
            cell.offset[k] = entry.sums[k];
            cell.normal[k] = entry.sums[3 + k];
        }
        cells.push_back(cell);
    }
    std::sort(cells.begin(), cells.end(),
              [](const MetCell& a, const MetCell& b) { return a.key < b.key; });
    return cells;
}

void NewCells::restore(const std::vector<MetCell>& cells) noexcept {
    clear();
    for (const MetCell& cell : cells) {
        Entry* const entry = entry_of(cell.key);
        if (entry == nullptr) return;
        entry->count = cell.count;
        for (std::size_t k = 0; k < 3; ++k) {
            entry->sums[k] = cell.offset[k];
            entry->sums[3 + k] = cell.normal[k];
        }
    }
}

void NewCells::clear() noexcept {
    if (empty()) return;
    for (std::size_t i = 0; i < kSlots; ++i) {
        Entry& entry = entries_[i];
        if (entry.key == kEmpty) continue;
        entry.key = kEmpty;
        entry.count = 0;
        for (auto& sum : entry.sums) sum = 0;
    }
    count_ = 0;
}

}  // namespace lightcull
