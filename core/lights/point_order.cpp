#include "lights/point_order.h"

#include <algorithm>
#include <utility>

#include "base/float3_math.h"
#include "base/morton.h"
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

}  // namespace

std::vector<std::uint32_t> order_points(Span<const ShadingPoint> points, std::uint32_t set_count) {
    std::vector<std::uint32_t> order(points.size());
    if (points.empty()) return order;
    const MortonCurve curve(points);
    // Counting sort by set, then each set by place; the index breaks ties.
    std::vector<std::uint32_t> ends(set_count + 1);
    for (const ShadingPoint& point : points) ++ends[point.set];
    std::uint32_t sum = 0;
    for (std::uint32_t& end : ends) sum += std::exchange(end, sum);
    std::vector<std::uint64_t> keys(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        keys[ends[points[i].set]++] = (std::uint64_t{curve.place(points[i].position)} << 32) | i;
    }
    for_each_block(set_count, 1, [&](std::size_t set, std::size_t) {
        const std::uint32_t begin = set == 0 ? 0 : ends[set - 1];
        std::sort(keys.begin() + begin, keys.begin() + ends[set]);
        for (std::uint32_t i = begin; i < ends[set]; ++i) {
            order[i] = static_cast<std::uint32_t>(keys[i]);
        }
    });
    return order;
}

}  // namespace lightcull
