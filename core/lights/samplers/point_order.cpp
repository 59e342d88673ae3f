#include "lights/samplers/point_order.h"

#include <lightcull/error.h>

#include <algorithm>
#include <new>
#include <string>
#include <utility>

#include "base/float3_math.h"
#include "base/morton.h"
#include "base/parallel_blocks.h"
#include "base/radix_sort.h"

namespace lightcull {
namespace {

struct Box {
    float3 low, high;
};

/// A box around some 256 points, or one in sixteen where that is more: packets are no worse for it,
/// and memory is read for those alone.
Box box_of_sample(Span<const ShadingPoint> points) noexcept {
    constexpr std::size_t kEnough = 256, kMaxStep = 16;
    const std::size_t step = std::clamp(points.size() / kEnough, std::size_t{1}, kMaxStep);
    Box box{points[0].position, points[0].position};
    for (std::size_t i = step; i < points.size(); i += step) {
        box.low = min(box.low, points[i].position);
        box.high = max(box.high, points[i].position);
    }
    return box;
}

class MortonCurve {
  public:
    explicit MortonCurve(const Box& box) noexcept : low_(box.low) {
        const float3 extent = box.high - box.low;
        const float longest = std::max({extent.x, extent.y, extent.z});
        scale_ = longest > 0.0f ? 1023.0f / longest : 0.0f;
    }
    /// The place of a point on the curve, below 2^20: finer cells would only make the sorting
    /// longer.
    std::uint32_t place(float3 x) const noexcept {
        const float3 at = (x - low_) * scale_;
        return morton_code(digits(at.x), digits(at.y), digits(at.z)) >> 10;
    }

  private:
    /// The digits of a coordinate. They are clamped, for the box is that of a sample, and 0 for
    /// what is no number: an extent may be too large for a float.
    static std::uint32_t digits(float at) noexcept {
        return at > 0.0f ? static_cast<std::uint32_t>(std::min(at, 1023.0f)) : 0;
    }

    float3 low_;
    float scale_;
};

constexpr std::size_t kBlock = 4096;

/// The place and the set of each point, in the upper and the lower half.
std::vector<std::uint64_t> places_and_sets(Span<const ShadingPoint> points) {
    const MortonCurve curve(box_of_sample(points));
    std::vector<std::uint64_t> keys(points.size());
    for_each_block(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            keys[i] = (std::uint64_t{curve.place(points[i].position)} << 32) | points[i].set;
        }
    });
    return keys;
}

std::uint32_t lower_half(std::uint64_t key) noexcept {
    return static_cast<std::uint32_t>(key);
}

/// A run of a list of keys.
struct Run {
    std::uint32_t begin, end;
};

/// Groups the points of each set that has any, as places and indices; `keys` has places and sets.
std::vector<std::uint64_t> group_by_set(Span<const std::uint64_t> keys, std::uint32_t set_count,
                                        std::vector<Run>& sets) {
    std::vector<std::uint32_t> next(set_count);
    for (const std::uint64_t key : keys) ++next[lower_half(key)];
    std::uint32_t sum = 0;
    for (std::uint32_t& count : next) {
        if (count > 0) sets.push_back({sum, sum + count});
        sum += std::exchange(count, sum);
    }
    std::vector<std::uint64_t> grouped(keys.size());
    for (std::uint32_t i = 0; i < keys.size(); ++i) {
        constexpr std::uint64_t kUpperHalf = 0xffffffff00000000u;
        grouped[next[lower_half(keys[i])]++] = (keys[i] & kUpperHalf) | i;
    }
    return grouped;
}

/// Takes the lower halves of `keys`, a few of each run in turn.
std::vector<std::uint32_t> take_turns(Span<const std::uint64_t> keys, std::vector<Run> runs) {
    constexpr std::uint32_t kAtATime = 16;
    std::vector<std::uint32_t> order;
    order.reserve(keys.size());
    while (!runs.empty()) {
        for (Run& run : runs) {
            const std::uint32_t end = std::min(run.end, run.begin + kAtATime);
            while (run.begin < end) order.push_back(lower_half(keys[run.begin++]));
        }
        const auto done = [](const Run& run) { return run.begin == run.end; };
        runs.erase(std::remove_if(runs.begin(), runs.end(), done), runs.end());
    }
    return order;
}

}  // namespace

std::vector<std::uint32_t> order_points(Span<const ShadingPoint> points,
                                        std::uint32_t set_count) try {
    if (points.empty()) return {};
    std::vector<std::uint64_t> scratch = places_and_sets(points);
    std::vector<Run> sets;
    std::vector<std::uint64_t> keys = group_by_set(scratch, set_count, sets);
    for_each_block(sets.size(), 1, [&](std::size_t set, std::size_t) {
        const Run run = sets[set];
        sort_keys<2>(keys.data() + run.begin, scratch.data() + run.begin, run.end - run.begin);
    });
    return take_turns(keys, std::move(sets));
} catch (const std::bad_alloc&) {
    throw Error("select(): no memory to put " + std::to_string(points.size()) + " points in order");
}

}  // namespace lightcull
