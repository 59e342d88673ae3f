#include "render/looseness.h"

#include "base/memory_size.h"
#include "render/morton_sort.h"

#include <ImathBox.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>

namespace lightcull {
namespace {

/// As many triangles as a few leaves of a tree.
constexpr std::size_t kRun = 16;
/// The most runs that are looked at: as many tell of all.
constexpr std::size_t kMostRuns = 1024;

}  // namespace

Looseness::Looseness(Span<const V3f> positions, Span<const std::uint32_t> indices) {
    std::vector<V3f> middles;
    middles.reserve(indices.size() / 3);
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        middles.push_back(
            (positions[indices[i]] + positions[indices[i + 1]] + positions[indices[i + 2]]) / 3.0f);
    }
    std::vector<std::uint32_t> order(middles.size());
    std::iota(order.begin(), order.end(), 0u);
    std::vector<std::uint64_t> keys;
    sort_by_morton_code(middles, order, keys);
    const std::size_t runs = (order.size() + kRun - 1) / kRun;
    const std::size_t step = kRun * std::max<std::size_t>((runs + kMostRuns - 1) / kMostRuns, 1);
    for (std::size_t i = 0; i < order.size(); i += step) {
        const auto begin = order.begin() + static_cast<std::ptrdiff_t>(i);
        const auto count = static_cast<std::ptrdiff_t>(std::min(kRun, order.size() - i));
        triangles_.insert(triangles_.end(), begin, begin + count);
    }
    built_area_ = area(positions, indices);
}

float Looseness::growth(Span<const V3f> positions, Span<const std::uint32_t> indices) const {
    const double now = area(positions, indices);
    if (built_area_ > 0.0) return static_cast<float>(now / built_area_);
    return now > 0.0 ? std::numeric_limits<float>::infinity() : 1.0f;
}

double Looseness::area(Span<const V3f> positions, Span<const std::uint32_t> indices) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < triangles_.size(); i += kRun) {
        Imath::Box3f box;
        for (std::size_t k = i; k < std::min(i + kRun, triangles_.size()); ++k) {
            const std::size_t first = std::size_t{3} * triangles_[k];
            for (std::size_t c = 0; c < 3; ++c) box.extendBy(positions[indices[first + c]]);
        }
        const Imath::V3d size(box.size());
        sum += size.x * size.y + size.y * size.z + size.z * size.x;
    }
    return sum;
}

std::size_t Looseness::memory_size() const noexcept {
    return size_of(triangles_);
}

}  // namespace lightcull
