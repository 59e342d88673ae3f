#include "base/random.h"
#include "render/camera.h"
#include "unit/render/render_support.h"

#include <doctest/doctest.h>

#include <cmath>

using lightcull::Camera;
using lightcull::CameraRays;
using lightcull::Ray;
using lightcull::V2f;
using lightcull::V3f;
using render_support::look;

TEST_CASE("a pinhole's rays span its field of view, x to the right and y down") {
    const Camera camera = look({1, 2, 3}, {1, 2, -5}, 1.0f);
    const CameraRays rays(camera, 200, 100);

    const Ray center = rays.ray({100, 50}, {0.3f, 0.9f});
    CHECK(center.origin == V3f(1, 2, 3));
    CHECK((center.direction - V3f(0, 0, -1)).length() < 1e-6f);

    const float tangent = std::tan(0.5f);
    const V3f top_left = rays.ray({0, 0}, {0.5f, 0.5f}).direction;
    CHECK(top_left.x / -top_left.z == doctest::Approx(-2.0f * tangent));
    CHECK(top_left.y / -top_left.z == doctest::Approx(tangent));
    const V3f bottom_right = rays.ray({200, 100}, {0.5f, 0.5f}).direction;
    CHECK(bottom_right.x / -bottom_right.z == doctest::Approx(2.0f * tangent));
    CHECK(bottom_right.y / -bottom_right.z == doctest::Approx(-tangent));
}

TEST_CASE("a thin lens is sharp in its plane of focus and spreads over its aperture") {
    Camera camera = look({0, 0, 0}, {3, 0, 0}, 0.8f);
    camera.aperture_radius = 0.25f;
    camera.focus_distance = 4.0f;
    const CameraRays lens(camera, 64, 64);
    camera.aperture_radius = 0.0f;
    const CameraRays pinhole(camera, 64, 64);

    const V2f place(10, 50);
    const V3f through = pinhole.ray(place, {0.5f, 0.5f}).direction;
    const V3f sharp = through * (4.0f / through.x);
    float widest = 0.0f;
    lightcull::RandomStream random(1);
    for (int i = 0; i < 100; ++i) {
        const float x = random.next();
        const V2f u(x, random.next());
        const Ray ray = lens.ray(place, u);
        CHECK(ray.direction.length() == doctest::Approx(1.0));
        CHECK(ray.origin.x == doctest::Approx(0.0));
        CHECK(ray.origin.length() <= 0.25f * 1.0001f);
        widest = std::max(widest, ray.origin.length());
        const V3f at_focus = ray.origin + ray.direction * ((4.0f - ray.origin.x) / ray.direction.x);
        CHECK((at_focus - sharp).length() < 1e-5f);
    }
    CHECK(widest > 0.2f);
}

TEST_CASE(
    "orthographic rays are parallel and start on a rectangle of the height that is asked for") {
    Camera camera = look({1, 2, 3}, {1, 2, -5}, 1.0f);
    camera.orthographic_height = 4.0f;
    const CameraRays rays(camera, 200, 100);
    const Ray center = rays.ray({100, 50}, {0.3f, 0.9f}), top_left = rays.ray({0, 0}, {0.1f, 0.2f});
    for (const Ray& ray : {center, top_left}) {
        CHECK((ray.direction - V3f(0, 0, -1)).length() < 1e-6f);
    }
    CHECK((center.origin - V3f(1, 2, 3)).length() < 1e-6f);
    CHECK((top_left.origin - V3f(1.0f - 4.0f, 2.0f + 2.0f, 3.0f)).length() < 1e-6f);
}
