#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "base/random.h"
#include "lights/tree/enclosing_sphere.h"
#include "unit/test_lights.h"

using namespace lightcull;
using namespace lightcull::testing;

TEST_CASE("enclosing sphere: both spheres hold those of all that it is about") {
    RandomStream random(1);
    for (int run = 0; run < 2000; ++run) {
        std::vector<EnclosingSphere> spheres(static_cast<std::size_t>(1 + run % 8));
        for (EnclosingSphere& sphere : spheres) {
            sphere.center = random_in_box(random, 1.0f);
            sphere.bounds = std::exp(-10.0f * random.next());
            sphere.radius = sphere.bounds + std::exp(-10.0f * random.next());
        }
        const EnclosingSphere all = enclose(spheres, kSphereRoundUp);
        double least_radius = 0.0, least_bounds = 0.0;
        for (const EnclosingSphere& sphere : spheres) {
            const double x =
                static_cast<double>(sphere.center.x) - static_cast<double>(all.center.x);
            const double y =
                static_cast<double>(sphere.center.y) - static_cast<double>(all.center.y);
            const double z =
                static_cast<double>(sphere.center.z) - static_cast<double>(all.center.z);
            const double away = std::sqrt(x * x + y * y + z * z);
            least_radius = std::max(least_radius, away + static_cast<double>(sphere.radius));
            least_bounds = std::max(least_bounds, away + static_cast<double>(sphere.bounds));
        }
        CHECK(static_cast<double>(all.radius) >= least_radius);
        CHECK(static_cast<double>(all.bounds) >= least_bounds);
        CHECK(static_cast<double>(all.radius) <= least_radius * (1.0 + 2e-6));
        CHECK(static_cast<double>(all.bounds) <= least_bounds * (1.0 + 2e-6));
    }
}

TEST_CASE("enclosing sphere: its centre is the middle of the box around spheres") {
    const std::vector<EnclosingSphere> spheres{{{0, 0, 0}, 1.0f, 0.5f}, {{4, 2, 0}, 3.0f, 0.0f}};
    const EnclosingSphere all = enclose(spheres, 1.0f);
    CHECK(all.center.x == 3.0f);  // -1 to 7
    CHECK(all.center.y == 2.0f);  // -1 to 5
    CHECK(all.center.z == 0.0f);
}

TEST_CASE(
    "enclosing sphere: it is somewhere, and holds all, where the range of a sun is infinite") {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const std::vector<EnclosingSphere> spheres{{{0x1p40f, 0, 0}, kInfinity, 0.0f},
                                               {{4, 2, 0}, 3.0f, 0.5f}};
    const EnclosingSphere all = enclose(spheres, kSphereRoundUp);
    CHECK(std::isfinite(all.center.x));
    CHECK(std::isfinite(all.center.y));
    CHECK(all.radius == kInfinity);
    CHECK(all.bounds >= 0x1p40f);
}
