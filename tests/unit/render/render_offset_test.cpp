#include "base/random.h"
#include "render/emitter.h"
#include "render/scene_data.h"
#include "render/surface.h"
#include "render/warp.h"
#include "unit/render/render_support.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

/// These tests show that rays that leave a surface neither hit it again nor pass through its
/// neighbours, whatever the size of the scene and wherever it lies.

using namespace render_support;
using lightcull::Basis;
using lightcull::Hit;
using lightcull::kNoHit;
using lightcull::RandomStream;
using lightcull::Ray;
using lightcull::Surface;
using lightcull::V2f;
using lightcull::V3f;

namespace {

struct Place {
    float scale;
    V3f offset;
    int allowed = 0;  ///< number of rays of 100,000 that may go wrong
};

const std::vector<Place>& places() {
    static const std::vector<Place> all{
        {1e-3f, V3f(0.0f)},
        {1.0f, V3f(0.0f)},
        {1e3f, V3f(0.0f)},
        {1e-3f, V3f(0.03f, -0.1f, 0.07f)},
        {1.0f, V3f(30.0f, -100.0f, 70.0f)},
        {1e3f, V3f(3e4f, -1e5f, 7e4f)},
        // Here floats are 0.06 mm apart: a point in a corner may come to lie behind the other wall.
        {1.0f, V3f(1000.0f, 0.0f, 0.0f), 10},
    };
    return all;
}

float3 moved(const Place& place, float3 p) {
    return {p.x * place.scale + place.offset.x, p.y * place.scale + place.offset.y,
            p.z * place.scale + place.offset.z};
}

Shape moved(const Place& place, Shape shape) {
    for (float3& p : shape.positions) p = moved(place, p);
    return shape;
}

/// The surfaces that rays from a point in all directions meet.
std::vector<Surface> seen_from(const SceneData& scene, const V3f& point, std::uint64_t key,
                               std::size_t count) {
    RandomStream random(key);
    std::vector<Ray> rays;
    while (rays.size() < count) {
        const float x = 2.0f * random.next() - 1.0f, y = 2.0f * random.next() - 1.0f;
        const V3f d(x, y, 2.0f * random.next() - 1.0f);
        if (d.length() > 0.1f) rays.push_back({point, d.normalized()});
    }
    std::vector<Hit> hits(rays.size());
    scene.ray_tracer->intersect(rays, hits, false);
    std::vector<Surface> surfaces;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].triangle != kNoHit) {
            surfaces.push_back(make_surface(scene, hits[i], rays[i].direction));
        }
    }
    return surfaces;
}

/// Rays into the hemisphere over each surface, down to grazing ones.
std::vector<Ray> leaving(const std::vector<Surface>& surfaces) {
    RandomStream random(9);
    std::vector<Ray> rays;
    for (const Surface& s : surfaces) {
        const float cosine = std::pow(random.next(), 3.0f);
        const float angle = 2.0f * lightcull::kPi * random.next();
        const float sine = std::sqrt(1.0f - cosine * cosine);
        const V3f d(sine * std::cos(angle), sine * std::sin(angle), cosine);
        const V3f direction = Basis(s.normal).to_world(d);
        if (direction.dot(s.normal) > 0.0f) rays.push_back({s.origin, direction});
    }
    return rays;
}

Shape box() {
    // Walls of many sizes of triangle, turned so that none lies along an axis.
    Shape s;
    s.add_level_square({0, 0, 0}, 1.0f, true);
    s.add_level_square({0, 1.5f, 0}, 1.0f, false);
    const float3 low[] = {{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}};
    for (int i = 0; i < 4; ++i) {
        const float3 a = low[i], b = low[(i + 1) % 4];
        s.add_quad(b, a, {a.x, 1.5f, a.z}, {b.x, 1.5f, b.z});
    }
    for (float3& p : s.positions) {
        const float x = 0.8f * p.x + 0.6f * p.z, z = -0.6f * p.x + 0.8f * p.z;
        p = {0.96f * x - 0.28f * p.y, 0.28f * x + 0.96f * p.y, z};
    }
    return s;
}

}  // namespace

TEST_CASE("rays that leave a convex body meet nothing") {
    for (const Place& place : places()) {
        CAPTURE(place.scale);
        CAPTURE(place.offset.x);
        Scene scene;
        scene.add_material({});
        Shape sphere;
        sphere.add_sphere({0, 0, 0}, 1.0f, 20);
        scene.add_mesh(moved(place, sphere).mesh("sphere", 0));
        scene.commit();
        std::vector<Surface> surfaces;
        for (const float3 from : {float3{3, 0, 1}, float3{-2, 3, 0}, float3{0, -1, -2}}) {
            const auto more =
                seen_from(data_of(scene), lightcull::to_v3f(moved(place, from)), 1, 100000);
            surfaces.insert(surfaces.end(), more.begin(), more.end());
        }
        const std::vector<Ray> rays = leaving(surfaces);
        REQUIRE(rays.size() > 5000);
        std::vector<Hit> hits(rays.size());
        data_of(scene).ray_tracer->intersect(rays, hits, false);
        int again = 0;
        for (const Hit& hit : hits) again += hit.triangle != kNoHit ? 1 : 0;
        CHECK(again <= place.allowed);
    }
}

TEST_CASE("rays inside a closed room never leave it, and its lamp is seen from everywhere") {
    for (const Place& place : places()) {
        CAPTURE(place.scale);
        CAPTURE(place.offset.x);
        Scene scene;
        scene.add_material({});
        Shape lamp;
        lamp.add_level_square({0, 0.9f, 0}, 0.2f, false);
        scene.add_mesh(moved(place, box()).mesh("room", 0));
        const Shape moved_lamp = moved(place, lamp);
        scene.add_mesh(moved_lamp.mesh("lamp", 0, emission(1.0f)));
        scene.commit();
        const auto& impl = data_of(scene);
        const auto surfaces =
            seen_from(impl, lightcull::to_v3f(moved(place, {0.1f, 0.5f, 0.2f})), 2, 100000);
        REQUIRE(surfaces.size() == 100000);

        const std::vector<Ray> rays = leaving(surfaces);
        std::vector<Hit> hits(rays.size());
        impl.ray_tracer->intersect(rays, hits, false);
        int lost = 0;
        for (const Hit& hit : hits) lost += hit.triangle == kNoHit ? 1 : 0;
        CHECK(lost <= place.allowed);

        RandomStream random(3);
        std::vector<Ray> shadow_rays;
        for (const Surface& s : surfaces) {
            const float x = random.next();
            const auto sample =
                sample_emitter(impl, impl.emitters[0], s.position, {0.5, V2f(x, random.next())});
            if (sample.radiance.x == 0.0f || sample.direction.dot(s.normal) <= 0.0f) continue;
            shadow_rays.push_back(lightcull::segment(s.origin, sample.place, sample.triangle));
        }
        REQUIRE(shadow_rays.size() > 10000);
        std::vector<std::uint8_t> occluded(shadow_rays.size());
        impl.ray_tracer->occluded(shadow_rays, occluded);
        int hidden = 0;
        for (const std::uint8_t o : occluded) hidden += o;
        CHECK(hidden <= place.allowed);
    }
}
