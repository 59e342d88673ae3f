#include "virtual_lights/maps/imperfect_shadow_maps.h"
#include "unit/render/render_support.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

using namespace render_support;

namespace {

constexpr std::uint32_t kParts = 16, kPerMap = 8192;

/// A floor of 4 m, and half a metre above its middle a plate of 1 m.
PointCloud cloud_of_plate_and_floor() {
    Scene scene;
    scene.add_material(diffuse(0.5f));
    Shape shape;
    shape.add_level_square({0, 0, 0}, 2.0f, true);
    shape.add_level_square({0, 0.5f, 0}, 0.5f, true);
    scene.add_mesh(shape.mesh("plate", 0));
    scene.commit();
    return {data_of(scene), kParts, kPerMap, 1};
}

VirtualLight light_at(const V3f& position, const V3f& normal) {
    return {position, normal, normal, V3f(1.0f), V3f(0.0f), 1.0f, Lobe::kDiffuse};
}

}  // namespace

TEST_CASE("point cloud: every part is even by area") {
    const auto cloud = cloud_of_plate_and_floor();
    REQUIRE(cloud.part_count() == kParts);
    double all_x = 0.0;
    for (std::size_t part = 0; part < kParts; ++part) {
        CHECK(cloud.part(part).size() == kPerMap);
        double on_plate = 0.0, x = 0.0;
        for (const CloudPoint& point : cloud.part(part)) {
            on_plate += point.position.y > 0.25f ? 1.0 : 0.0;
            x += static_cast<double>(point.position.x);
            CHECK(point.normal.y == doctest::Approx(1.0));
        }
        CHECK(on_plate / kPerMap == doctest::Approx(1.0 / 17.0).scale(0.0).epsilon(0.2));
        CHECK(std::fabs(x / kPerMap) < 0.08);
        all_x += x;
    }
    CHECK(std::fabs(all_x / kPerMap / kParts) < 0.02);
    CHECK(cloud.part(0)[0].position != cloud.part(1)[0].position);
    CHECK(cloud.part(3)[0].radius ==
          doctest::Approx(std::sqrt(17.0 / render_support::kPi / kPerMap)));
}

TEST_CASE("point cloud: what is near is found, and little else") {
    const auto cloud = cloud_of_plate_and_floor();
    const V3f place(0.3f, 0.2f, -0.4f);
    for (const float reach : {0.0f, 0.25f, 0.7f, 10.0f, std::numeric_limits<float>::infinity()}) {
        std::size_t visited = 0, near = 0, expected = 0;
        const auto is_near = [&](const CloudPoint& point) {
            return lightcull::max_component(abs(point.position - place)) <= reach;
        };
        cloud.for_near(5, place, reach, [&](const CloudPoint& point) {
            ++visited;
            near += is_near(point) ? 1 : 0;
        });
        for (const CloudPoint& point : cloud.part(5)) expected += is_near(point) ? 1 : 0;
        CHECK(near == expected);
        CHECK(visited == near);
        CHECK((near > 0) == (reach > 0.0f));
    }
}

TEST_CASE("imperfect shadow maps: a plate casts a shadow") {
    const auto cloud = cloud_of_plate_and_floor();
    // The light is below the plate, facing up: Program 1 keeps what turns its back on the light.
    const std::vector<VirtualLight> lights{light_at({0, 0.01f, 0}, {0, 1, 0})};
    const float ranges[] = {10.0f};
    const ImperfectShadowMaps maps(lights, ranges, cloud, 1);
    // Seen from the light the plate ends at 45 degrees.
    CHECK(maps.occluded(0, lights[0], {0, 2.0f, 0}));
    CHECK(maps.occluded(0, lights[0], {1.2f, 2.0f, 0.3f}));
    CHECK(!maps.occluded(0, lights[0], {3.0f, 2.0f, 0}));
    CHECK(!maps.occluded(0, lights[0], {0, 3.0f, 5.0f}));
    CHECK(!maps.occluded(0, lights[0], {0.1f, 0.45f, 0}));
    // The plate does not shade itself.
    for (float x = -0.1f; x < 0.1f; x += 0.007f) {
        CHECK(!maps.occluded(0, lights[0], {x, 0.5f, 0.03f}));
    }
}

TEST_CASE("imperfect shadow maps: the shadow of a plate to one side lies on that side") {
    Scene scene;
    scene.add_material(diffuse(0.5f));
    Shape shape;
    shape.add_level_square({0.8f, 0.8f, 0.2f}, 0.3f, true);
    scene.add_mesh(shape.mesh("plate", 0));
    scene.commit();
    const PointCloud cloud(data_of(scene), 1, kPerMap, 1);
    const std::vector<VirtualLight> lights{light_at({0, 0, 0}, {0, 1, 0})};
    const float ranges[] = {10.0f};
    const ImperfectShadowMaps maps(lights, ranges, cloud, 1);
    CHECK(maps.occluded(0, lights[0], {1.6f, 1.6f, 0.4f}));
    CHECK(!maps.occluded(0, lights[0], {-1.6f, 1.6f, -0.4f}));
    for (const float side : {-1.0f, 1.0f}) {
        CHECK(!maps.occluded(0, lights[0], {0.4f * side, 1.6f, 1.6f}));
        CHECK(!maps.occluded(0, lights[0], {0.4f * side, 1.6f, -1.6f}));
    }
}

TEST_CASE("imperfect shadow maps: points are culled by range and facing") {
    const auto cloud = cloud_of_plate_and_floor();
    // The light is above both, facing down: both face it.
    const std::vector<VirtualLight> above{light_at({0, 2, 0}, {0, -1, 0})};
    const std::vector<VirtualLight> below{light_at({0, -1, 0}, {0, 1, 0})};
    const float far[] = {100.0f}, near[] = {0.5f};
    const auto splatted = [&](const std::vector<VirtualLight>& lights, Span<const float> ranges) {
        return ImperfectShadowMaps(lights, ranges, cloud, 1).splatted();
    };
    CHECK(splatted(above, far) == 0);
    CHECK(splatted(below, far) == kPerMap);
    CHECK(splatted(below, near) == 0);
    // The light is between both, facing down: all that turns its back on it is below its surface.
    const std::vector<VirtualLight> between{light_at({0, 0.25f, 0}, {0, -1, 0})};
    CHECK(splatted(between, far) == 0);
}

TEST_CASE("imperfect shadow maps: a map has the points of one part in range, not always the same") {
    const auto cloud = cloud_of_plate_and_floor();
    const std::vector<VirtualLight> below{light_at({0, -1, 0}, {0, 1, 0})};
    const float ranges[] = {1.8f};
    std::set<std::uint64_t> of_parts, found;
    for (std::size_t part = 0; part < kParts; ++part) {
        std::uint64_t in_range = 0;
        for (const CloudPoint& point : cloud.part(part)) {
            in_range += (point.position - below[0].position).length() < ranges[0] ? 1 : 0;
        }
        of_parts.insert(in_range);
    }
    for (std::uint64_t key = 0; key < 8; ++key) {
        const std::uint64_t splatted = ImperfectShadowMaps(below, ranges, cloud, key).splatted();
        CHECK(of_parts.count(splatted) == 1);
        found.insert(splatted);
    }
    CHECK(found.size() > 1);
}

TEST_CASE("imperfect shadow maps: without geometry nothing is dark") {
    const std::vector<VirtualLight> lights{light_at({0, 0, 0}, {0, 1, 0})};
    const float ranges[] = {1.0f};
    const ImperfectShadowMaps maps(lights, ranges, {}, 1);
    CHECK(!maps.occluded(0, lights[0], {0, 1, 0}));
    Scene scene;
    scene.commit();
    CHECK(PointCloud(data_of(scene), 3, 100, 1).part_count() == 0);
}
