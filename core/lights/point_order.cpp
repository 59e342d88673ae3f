#include "lights/point_order.h"

#include <algorithm>
#include <utility>

#include "base/float3_math.h"
#include "base/morton.h"
#include "base/radix_sort.h"
#include "lights/parallel_blocks.h"

namespace lightcull {
namespace {

class MortonCurve {
  public:
    explicit MortonCurve(Span<const ShadingPoint> points) noexcept {
        low_ = points[0].position;
        float3 high = low_;
        for (const ShadingPoint& point : points) {
            low_ = min(low_, point.position);
            high = max(high, point.position);
        }
        const float3 extent = high - low_;
        const float longest = std::max({extent.x, extent.y, extent.z});
        scale_ = longest > 0.0f ? 1023.0f / longest : 0.0f;
    }
    std::uint32_t place(float3 x) const noexcept {
        const float3 at = (x - low_) * scale_;
        return morton_code(digits(at.x), digits(at.y), digits(at.z));
    }

  private:
    /// Clamped, and 0 for what is no number: an extent may be too large for a float.
    static std::uint32_t digits(float at) noexcept {
        return at > 0.0f ? static_cast<std::uint32_t>(std::min(at, 1023.0f)) : 0;
    }

    float3 low_;
    float scale_;
};

/// The indices in `keys`, those of a set up to its end in `ends`, in runs of the sets in turn.
std::vector<std::uint32_t> take_turns(Span<const std::uint64_t> keys,
                                      Span<const std::uint32_t> ends) {
    constexpr std::uint32_t kRunSize = 16;
    std::vector<std::uint32_t> order;
    order.reserve(keys.size());
    for (std::uint32_t done = 0; order.size() < keys.size(); done += kRunSize) {
        std::uint32_t begin = 0;
        for (const std::uint32_t end : ends) {
            const std::uint32_t last = std::min(end - begin, done + kRunSize);
            for (std::uint32_t i = done; i < last; ++i) {
                order.push_back(static_cast<std::uint32_t>(keys[begin + i]));
            }
            begin = end;
        }
    }
    return order;
}

}  // namespace

std::vector<std::uint32_t> order_points(Span<const ShadingPoint> points, std::uint32_t set_count) {
    if (points.empty()) return {};
    const MortonCurve curve(points);
    // Counting sort by set, then each set by place; the index breaks ties.
    std::vector<std::uint32_t> ends(set_count);
    for (const ShadingPoint& point : points) ++ends[point.set];
    std::uint32_t sum = 0;
    for (std::uint32_t& end : ends) sum += std::exchange(end, sum);
    std::vector<std::uint64_t> keys(points.size()), sorted(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        keys[ends[points[i].set]++] = (std::uint64_t{curve.place(points[i].position)} << 32) | i;
    }
    for_each_block(set_count, 1, [&](std::size_t set, std::size_t) {
        const std::uint32_t begin = set == 0 ? 0 : ends[set - 1];
        sort_keys(keys.data() + begin, sorted.data() + begin, ends[set] - begin);
    });
    return take_turns(sorted, ends);
}

}  // namespace lightcull
