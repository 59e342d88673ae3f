#include "virtual_lights/imperfect_shadow_maps.h"
#include "render_support.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace render_support;

namespace {

/// A floor of 4 m, and half a metre above its middle a plate of 1 m.
std::vector<CloudPoint> cloud_of_plate_and_floor(std::uint32_t per_map) {
    Scene scene;
    scene.add_material(diffuse(0.5f));
    Shape shape;
    shape.add_level_square({0, 0, 0}, 2.0f, true);
    shape.add_level_square({0, 0.5f, 0}, 0.5f, true);
    scene.add_mesh(shape.mesh("plate", 0));
    scene.commit();
    return make_point_cloud(scene.impl(), 16 * per_map, per_map, 1);
}

VirtualLight light_at(const V3f& position, const V3f& normal) {
    return {position, normal, normal, V3f(1.0f), V3f(0.0f), 1.0f, Lobe::kDiffuse};
}

constexpr std::uint32_t kPerMap = 8192;

}  // namespace

TEST_CASE("point cloud: even by area") {
    const auto cloud = cloud_of_plate_and_floor(kPerMap);
    CHECK(cloud.size() == 16 * kPerMap);
    double on_plate = 0.0, x = 0.0;
    for (const CloudPoint& point : cloud) {
        on_plate += point.position.y > 0.25f ? 1.0 : 0.0;
        x += static_cast<double>(point.position.x);
        CHECK(point.normal.y == doctest::Approx(1.0));
    }
    const auto count = static_cast<double>(cloud.size());
    CHECK(on_plate / count == doctest::Approx(1.0 / 17.0).epsilon(0.05));
    CHECK(std::fabs(x / count) < 0.02);
    CHECK(cloud[0].radius == doctest::Approx(std::sqrt(17.0 / render_support::kPi / kPerMap)));
}

TEST_CASE("imperfect shadow maps: a plate casts a shadow") {
    const auto cloud = cloud_of_plate_and_floor(kPerMap);
    // Below the plate, facing up: Program 1 keeps what turns its back on the light.
    const std::vector<VirtualLight> lights{light_at({0, 0.01f, 0}, {0, 1, 0})};
    const float ranges[] = {10.0f};
    const ImperfectShadowMaps maps(lights, ranges, cloud, kPerMap, 1);
    // Seen from the light the plate ends at 45 degrees.
    CHECK(maps.occluded(0, lights[0], {0, 2.0f, 0}));
    CHECK(maps.occluded(0, lights[0], {1.2f, 2.0f, 0.3f}));
    CHECK(!maps.occluded(0, lights[0], {3.0f, 2.0f, 0}));
    CHECK(!maps.occluded(0, lights[0], {0, 3.0f, 5.0f}));
    CHECK(!maps.occluded(0, lights[0], {0.1f, 0.45f, 0}));
}

TEST_CASE("imperfect shadow maps: points are culled by range and facing") {
    const auto cloud = cloud_of_plate_and_floor(kPerMap);
    // Above both, facing down: both face the light.
    const std::vector<VirtualLight> above{light_at({0, 2, 0}, {0, -1, 0})};
    const std::vector<VirtualLight> below{light_at({0, -1, 0}, {0, 1, 0})};
    const float far[] = {100.0f}, near[] = {0.5f};
    const auto splatted = [&](const std::vector<VirtualLight>& lights, Span<const float> ranges) {
        return ImperfectShadowMaps(lights, ranges, cloud, kPerMap, 1).splatted();
    };
    CHECK(splatted(above, far) == 0);
    CHECK(splatted(below, far) == kPerMap);
    CHECK(splatted(below, near) == 0);
}

TEST_CASE("imperfect shadow maps: without geometry nothing is dark") {
    const std::vector<VirtualLight> lights{light_at({0, 0, 0}, {0, 1, 0})};
    const float ranges[] = {1.0f};
    const ImperfectShadowMaps maps(lights, ranges, {}, kPerMap, 1);
    CHECK(!maps.occluded(0, lights[0], {0, 1, 0}));
    Scene scene;
    scene.commit();
    CHECK(make_point_cloud(scene.impl(), 100, 100, 1).empty());
}
