#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "base/float3_math.h"
#include "base/radix_sort.h"
#include "base/random.h"
#include "lights/samplers/point_order.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

namespace {

template <std::size_t kDigits>
void check_sort_keys() {
    for (const std::size_t count : {0u, 1u, 2u, 191u, 192u, 1000u, 5000u}) {
        for (const std::uint32_t different : {1u, 50u, 1u << (10 * kDigits)}) {
            CAPTURE(kDigits);
            CAPTURE(count);
            CAPTURE(different);
            std::vector<std::uint64_t> keys(count), scratch(count);
            for (std::uint32_t i = 0; i < count; ++i) {
                keys[i] = (hash(i, different) % different) << 32 | i;
            }
            std::vector<std::uint64_t> wanted = keys;
            std::sort(wanted.begin(), wanted.end());
            const std::uint64_t* sorted = sort_keys<kDigits>(keys.data(), scratch.data(), count);
            CHECK(std::equal(wanted.begin(), wanted.end(), sorted));
            if (kDigits % 2 == 0) CHECK(sorted == keys.data());
        }
    }
}

}  // namespace

TEST_CASE("keys are sorted as std::sort does it, many and few, with ties") {
    check_sort_keys<2>();
    check_sort_keys<3>();
}

TEST_CASE("points are ordered each once, in packets of one set") {
    constexpr std::uint32_t kSets = 16;
    for (const std::uint32_t count : {0u, 1u, 17u, 5000u}) {
        const std::vector<ShadingPoint> points = mixed_points(count, 3, kSets);
        std::vector<std::uint32_t> order = order_points(points, kSets);
        std::size_t changes = 0;
        for (std::size_t i = 1; i < order.size(); ++i) {
            changes += points[order[i]].set != points[order[i - 1]].set ? 1 : 0;
        }
        CHECK(changes <= count / 16 + kSets);
        std::vector<std::uint32_t> all(count);
        std::iota(all.begin(), all.end(), 0u);
        std::sort(order.begin(), order.end());
        CHECK(order == all);
    }
}

TEST_CASE("packets of a set are compact") {
    const std::vector<ShadingPoint> points = mixed_points(5000, 3, 1);
    const auto sum_of_extents = [&](const std::vector<std::uint32_t>& order) {
        constexpr std::size_t kPacket = 16;
        double sum = 0.0;
        for (std::size_t begin = 0; begin + kPacket <= order.size(); begin += kPacket) {
            float3 low = points[order[begin]].position, high = low;
            for (std::size_t i = begin; i < begin + kPacket; ++i) {
                low = min(low, points[order[i]].position);
                high = max(high, points[order[i]].position);
            }
            sum += static_cast<double>(length(high - low));
        }
        return sum;
    };
    std::vector<std::uint32_t> as_given(points.size());
    std::iota(as_given.begin(), as_given.end(), 0u);
    CHECK(sum_of_extents(order_points(points, 1)) < 0.4 * sum_of_extents(as_given));
}
