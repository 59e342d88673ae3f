#include "render/trigonometry.h"

#include <doctest/doctest.h>

#include <cmath>

using lightcull::arc_tangent;
using lightcull::sine_cosine;

namespace {

constexpr double kPi = 3.14159265358979323846;

}  // namespace

TEST_CASE("the arc tangent is the C library's in all quadrants, and relative to small angles") {
    for (int i = -4000; i <= 4000; ++i) {
        const double angle = kPi * i / 4000.0;
        for (const double length : {1e-20, 1.0, 1e20}) {
            const double y = length * std::sin(angle), x = length * std::cos(angle);
            CHECK(std::fabs(arc_tangent(y, x) - std::atan2(y, x)) <= 4e-9);
        }
    }
    for (int i = 0; i < 105; ++i) {
        const double y = 1e-12 * std::pow(1.3, i);
        CHECK(std::fabs(arc_tangent(y, 1.0) / std::atan2(y, 1.0) - 1.0) <= 1e-9);
    }
    CHECK(arc_tangent(0.0, 0.0) == 0.0);
    CHECK(arc_tangent(1.0, 0.0) == kPi / 2);
    CHECK(arc_tangent(-1.0, 0.0) == -kPi / 2);
    CHECK(arc_tangent(0.0, -1.0) == kPi);
}

TEST_CASE("sine and cosine are those of the angle, and of four times it") {
    for (int i = -1000; i <= 1000; ++i) {
        const double angle = kPi / 4 * i / 1000.0;
        const auto exact = sine_cosine(angle);
        CHECK(std::fabs(exact.sine - std::sin(angle)) <= 2e-9);
        CHECK(std::fabs(exact.cosine - std::cos(angle)) <= 2e-10);
        const auto around = exact.doubled().doubled();
        CHECK(std::fabs(around.sine - std::sin(4 * angle)) <= 1e-8);
        CHECK(std::fabs(around.cosine - std::cos(4 * angle)) <= 1e-8);
        const auto rounded = sine_cosine(static_cast<float>(angle));
        CHECK(std::fabs(static_cast<double>(rounded.sine) - std::sin(angle)) <= 1.2e-7);
        CHECK(std::fabs(static_cast<double>(rounded.cosine) - std::cos(angle)) <= 1.2e-7);
    }
}
