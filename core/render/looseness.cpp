#include "render/looseness.h"

#include "base/memory_size.h"
#include "base/parallel_blocks.h"
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

}  // namespace

Looseness::Looseness(Span<const V3f> positions, Span<const std::uint32_t> indices)
    : order_(indices.size() / 3) {
    std::iota(order_.begin(), order_.end(), 0u);
    std::vector<V3f> middles;
    middles.reserve(order_.size());
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        middles.push_back(
            (positions[indices[i]] + positions[indices[i + 1]] + positions[indices[i + 2]]) / 3.0f);
    }
    std::vector<std::uint64_t> keys;
    sort_by_morton_code(middles, order_, keys);
    built_area_ = area(positions, indices);
}

float Looseness::growth(Span<const V3f> positions, Span<const std::uint32_t> indices) const {
    const double now = area(positions, indices);
    if (built_area_ > 0.0) return static_cast<float>(now / built_area_);
    return now > 0.0 ? std::numeric_limits<float>::infinity() : 1.0f;
}

double Looseness::area(Span<const V3f> positions, Span<const std::uint32_t> indices) const {
    // A sum for each block, so that the total does not depend on threads.
    constexpr std::size_t kBlock = 256 * kRun;
    std::vector<double> sums((order_.size() + kBlock - 1) / kBlock);
    for_each_block(order_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        double sum = 0.0;
        for (std::size_t i = begin; i < end; i += kRun) {
            Imath::Box<Imath::V3d> box;
            for (std::size_t k = i; k < std::min(i + kRun, end); ++k) {
                const std::size_t first = std::size_t{3} * order_[k];
                for (std::size_t c = 0; c < 3; ++c) {
                    box.extendBy(Imath::V3d(positions[indices[first + c]]));
                }
            }
            const Imath::V3d size = box.size();
            sum += size.x * size.y + size.y * size.z + size.z * size.x;
        }
        sums[begin / kBlock] = sum;
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

std::size_t Looseness::memory_size() const noexcept {
    return size_of(order_);
}

}  // namespace lightcull
