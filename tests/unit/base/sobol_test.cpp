#include "base/sobol.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "unit/statistics.h"

namespace lightcull {
namespace {

constexpr std::uint32_t kDimensions = SobolPoint::kDimensions;

/// The number of boxes that hold no point, of those that a pair of coordinates of points from
/// `first` on is divided into: 2^a by 2^b, as many as there are points.
template <typename Point>
std::uint32_t empty_boxes(std::uint64_t key, std::uint64_t first, std::uint32_t x, std::uint32_t y,
                          std::uint32_t a, std::uint32_t b) {
    std::vector<std::uint8_t> met(std::size_t{1} << (a + b));
    for (std::uint64_t i = 0; i < met.size(); ++i) {
        const Point point(key, first + i);
        const std::uint64_t row = std::uint64_t{point.bits(x)} << a >> 32;
        const std::uint64_t column = std::uint64_t{point.bits(y)} << b >> 32;
        met[(row << b) + column] = 1;
    }
    std::uint32_t empty = 0;
    for (const std::uint8_t one : met) empty += one == 0 ? 1 : 0;
    return empty;
}

struct Sobol : SobolPoint {
    Sobol(std::uint64_t key, std::uint64_t index) : SobolPoint(mix(key), SobolIndex(index)) {}
};

/// What it must not be: independent numbers.
struct RandomPoint {
    std::uint64_t key, index;
    RandomPoint(std::uint64_t k, std::uint64_t i) : key(k), index(i) {}
    std::uint32_t bits(std::uint32_t dimension) const {
        return static_cast<std::uint32_t>(hash(key, index, dimension) >> 32);
    }
};

}  // namespace

TEST_CASE("each coordinate of points of a key falls once into each of as many intervals") {
    for (std::uint32_t dimension = 0; dimension < kDimensions; ++dimension) {
        CAPTURE(dimension);
        for (const std::uint32_t k : {1u, 3u, 8u, 11u}) {
            CAPTURE(k);
            for (const std::uint64_t block : {0u, 1u, 5u}) {
                CHECK(empty_boxes<Sobol>(k, block << k, dimension, 0, k, 0) == 0);
            }
        }
        // Beyond 2^16 points another sequence begins.
        CHECK(empty_boxes<Sobol>(3, 7u << 16, dimension, 0, 8, 0) == 0);
    }
    CHECK(empty_boxes<RandomPoint>(3, 0, 0, 0, 8, 0) > 60);
}

TEST_CASE("pairs of coordinates of points of a key cover the square") {
    for (std::uint32_t k = 2; k <= 10; ++k) {
        for (std::uint32_t a = 0; a <= k; ++a) {
            CAPTURE(k);
            CAPTURE(a);
            // The first two are a (0, 2)-sequence in base 2, the others are near it.
            CHECK(empty_boxes<Sobol>(k, 3u << k, 0, 1, a, k - a) == 0);
            for (std::uint32_t x = 0; x < kDimensions; ++x) {
                for (std::uint32_t y = 0; y < x; ++y) {
                    CHECK(empty_boxes<Sobol>(a, 0, x, y, a, k - a) <= 1u << k >> 1);
                }
            }
        }
    }
}

TEST_CASE("points of different keys are independent and uniform") {
    // Means over keys; 4.5 sigma: a false alarm of the 24 once in 6,000.
    constexpr int kKeys = 20000;
    for (const std::uint64_t index : {0u, 1u, 77u}) {
        for (std::uint32_t dimension = 0; dimension < kDimensions; ++dimension) {
            statistics::Accumulator value, product, of_pair;
            for (int key = 0; key < kKeys; ++key) {
                const auto at = [&](int k, std::uint64_t i) {
                    return double{Sobol(static_cast<std::uint64_t>(k), i)[dimension]} - 0.5;
                };
                value.add(at(key, index));
                product.add(at(key, index) * at(key + 1, index));
                of_pair.add(at(key, 2 * index) * at(key, 2 * index + 1));
            }
            CHECK(std::abs(z_of(value.estimate(), {0, 0})) < 4.5);
            CHECK(std::abs(z_of(product.estimate(), {0, 0})) < 4.5);
            // Those of one key are not: the two of a pair lie in different halves.
            CHECK(of_pair.estimate().mean < -0.05);
        }
    }
}

TEST_CASE("a fine coordinate has the digits of the coarse one, and more") {
    std::uint64_t seen = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const Sobol point(5, i);
        const double fine = point.fine(2);
        CHECK(fine >= 0.0);
        CHECK(fine < 1.0);
        CHECK(std::floor(fine * 0x1p24) == std::floor(double{point[2]} * 0x1p24));
        seen |= static_cast<std::uint64_t>(fine * 0x1p53);
    }
    CHECK(seen == (std::uint64_t{1} << 53) - 1);
}

}  // namespace lightcull
