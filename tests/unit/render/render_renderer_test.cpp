#include "base/random.h"
#include "unit/render/render_support.h"

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <vector>

using namespace render_support;

namespace {

/// A room with a glossy floor, lamps, a point, a spot and a sky seen through the roof.
std::shared_ptr<const Scene> small_world() {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.7f));
    scene->add_material(metal(0.3f, 0.9f));
    Shape floor, sphere, lamps;
    floor.add_level_square({0, 0, 0}, 4.0f, true);
    sphere.add_sphere({0.5f, 0.8f, 0}, 0.8f, 16);
    for (int i = 0; i < 25; ++i) {
        const int row = i / 5 - 2;
        const auto x = static_cast<float>(i % 5 - 2), z = static_cast<float>(row);
        lamps.add_level_square({1.3f * x, 2.0f, 1.3f * z}, 0.1f, false);
    }
    scene->add_mesh(floor.mesh("floor", 1));
    scene->add_mesh(sphere.mesh("sphere", 0));
    scene->add_mesh(lamps.mesh("lamps", 0, emission(10.0f)));
    scene->add_point_light({-2, 1, 1}, {1, 1, 2});
    scene->add_spot_light({2, 2, 2}, {-1, -1, -1}, {5, 4, 3}, 0.2f, 0.5f);
    scene->set_environment(constant_environment(0.2f));
    scene->set_camera(look({0, 1.5f, 5}, {0, 0.7f, 0}, 0.9f));
    return committed(scene);
}

RenderSettings wide_image(std::uint32_t threads) {
    RenderSettings settings;
    settings.width = 200;
    settings.height = 130;
    settings.max_depth = 5;
    settings.rr_depth = 3;
    settings.seed = 12;
    settings.threads = threads;
    return settings;
}

bool same_bits(const std::vector<float3>& a, const std::vector<float3>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float3)) == 0;
}

std::vector<float3> render(const std::shared_ptr<const Scene>& scene,
                           const RenderSettings& settings, const char* sampler,
                           std::uint32_t passes) {
    Renderer renderer(scene, settings, make_scene_sampler(sampler, *scene, settings));
    for (std::uint32_t i = 0; i < passes; ++i) renderer.render_pass();
    return renderer.image();
}

/// Passes calls on to another sampler, and cancels at the first selection once it is told to.
class CancellingSampler final : public ForwardingSampler {
  public:
    CancellingSampler(std::unique_ptr<LightSampler> inner, const std::atomic<bool>& armed,
                      std::atomic<bool>& cancel)
        : ForwardingSampler(std::move(inner)), armed_(armed), cancel_(cancel) {}

    using ForwardingSampler::select;
    void select(Span<const ShadingPoint> points, Span<const float> u,
                Span<Selection> selections) const override {
        ForwardingSampler::select(points, u, selections);
        if (armed_) cancel_ = true;
    }

  private:
    const std::atomic<bool>& armed_;
    std::atomic<bool>& cancel_;
};

/// A level square about the origin, seen from its back, 5 m above.
std::shared_ptr<Scene> square_from_above(float half_edge) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape floor;
    floor.add_level_square({0, 0, 0}, half_edge, false);
    scene->add_mesh(floor.mesh("seen from behind", 0));
    scene->set_camera(look({0, 5, 0}, {0, 0, 0}, 0.8f, {1, 0, 0}));
    scene->commit();
    return scene;
}

}  // namespace

TEST_CASE("the image is the same bits for one thread and many") {
    const auto scene = small_world();
    for (const char* sampler : {"power", "culled"}) {
        const auto one = render(scene, wide_image(1), sampler, 3);
        CHECK(same_bits(one, render(scene, wide_image(2), sampler, 3)));
        RenderSettings other = wide_image(1);
        other.seed = 13;
        CHECK_FALSE(same_bits(one, render(scene, other, sampler, 3)));
        CHECK_FALSE(same_bits(one, render(scene, wide_image(1), sampler, 2)));
    }
}

TEST_CASE("a cancelled pass leaves no trace, and the next one is as if it had not been") {
    const auto scene = small_world();
    const RenderSettings settings = wide_image(2);
    std::atomic<bool> armed{false}, cancel{false};
    Renderer renderer(scene, settings,
                      std::make_unique<CancellingSampler>(
                          make_scene_sampler("culled", *scene, settings), armed, cancel));
    REQUIRE(renderer.render_pass(&cancel));
    const auto before = renderer.image();
    const RenderStats stats = renderer.stats();

    armed = true;
    CHECK_FALSE(renderer.render_pass(&cancel));
    CHECK(same_bits(before, renderer.image()));
    CHECK(renderer.stats().passes == 1);
    CHECK(renderer.stats().rays == stats.rays);
    CHECK(renderer.stats().selections == stats.selections);

    armed = cancel = false;
    CHECK(renderer.render_pass(&cancel));
    CHECK(same_bits(render(scene, settings, "culled", 2), renderer.image()));
}

TEST_CASE("statistics count what was done") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape floor;
    floor.add_level_square({0, 0, 0}, 100.0f, true);
    scene->add_mesh(floor.mesh("floor", 0));
    scene->add_point_light({0, 5, 0}, {1, 1, 1});
    scene->set_camera(look({0, 5, 0}, {0, 0, 0}, 1.0f, {1, 0, 0}));
    scene->commit();
    RenderSettings settings = square_image(100, 2);
    settings.direct_light = DirectLight::kLights;
    Renderer renderer(scene, settings, make_sampler(UniformOptions{}, scene->lights()));
    CHECK(renderer.stats().passes == 0);
    renderer.render_pass();
    renderer.render_pass();
    CHECK(renderer.stats().passes == 2);
    CHECK(renderer.stats().selections == 20000);
    CHECK(renderer.stats().rays == 40000);
    CHECK(renderer.stats().seconds > 0.0);
    CHECK(renderer.stats().selection_seconds > 0.0);
    CHECK(renderer.stats().selection_seconds < 16 * renderer.stats().seconds);
}

TEST_CASE("a scene without anything, or without lights, renders black or its sky") {
    auto empty = std::make_shared<Scene>();
    empty->commit();
    for (const std::uint32_t depth : {1u, 5u}) {
        for (const char* sampler : {"uniform", "culled", "light_bvh"}) {
            const auto image = render(empty, square_image(8, depth), sampler, 2);
            CHECK(luminance(image[20]) == 0.0);
        }
    }
    auto sky = std::make_shared<Scene>();
    sky->set_environment(constant_environment(2.0f));
    sky->commit();
    CHECK(luminance(render(sky, square_image(8, 3), "culled", 2)[20]) == doctest::Approx(2.0));
}

TEST_CASE("camera points are first hits with the normal towards the camera") {
    const auto scene = square_from_above(100.0f);
    RenderSettings settings;
    const auto points = camera_points(*scene, settings, 128);
    CHECK(points.size() >= 100);
    CHECK(points.size() <= 160);
    float3 low = points[0].position, high = low;
    for (const ShadingPoint& point : points) {
        CHECK(std::fabs(point.position.y) < 1e-5f);
        CHECK(point.normal.y == doctest::Approx(1.0));
        low.x = std::fmin(low.x, point.position.x);
        high.x = std::fmax(high.x, point.position.x);
    }
    // The image shows 2 * 5 tan(0.4) of the floor from top to bottom.
    CHECK(high.x - low.x == doctest::Approx(4.2).scale(0.0).epsilon(0.2));
}

TEST_CASE("pixel points are what the middles of pixels show, and empty where that is nothing") {
    const auto scene = square_from_above(1.0f);
    RenderSettings settings;
    settings.width = 40;
    settings.height = 20;
    const auto points = pixel_points(*scene, settings);
    REQUIRE(points.size() == 800);
    const float half = 5.0f * std::tan(0.4f);
    int met = 0;
    for (std::uint32_t y = 0; y < 20; ++y) {
        for (std::uint32_t x = 0; x < 40; ++x) {
            // Up in the image is +x, and right is +z.
            const float up = half * (1.0f - (static_cast<float>(y) + 0.5f) / 10.0f);
            const float right = 2.0f * half * ((static_cast<float>(x) + 0.5f) / 20.0f - 1.0f);
            const auto& point = points[std::size_t{40} * y + x];
            const bool hit = std::fabs(up) < 1.0f && std::fabs(right) < 1.0f;
            REQUIRE(point.has_value() == hit);
            if (!hit) continue;
            ++met;
            CHECK(point->position.x == doctest::Approx(up).epsilon(1e-4));
            CHECK(point->position.z == doctest::Approx(right).epsilon(1e-4));
            CHECK(point->normal.y == doctest::Approx(1.0));
        }
    }
    CHECK(met > 10);
}

TEST_CASE("samples are finite and not negative, whatever the scene") {
    // The scene has mirrors, smooth normals that point anywhere, slivers, triangles without area,
    // lamps that lie in surfaces, and a sun.
    auto scene = std::make_shared<Scene>();
    scene->add_material(metal(0.0f));
    Material plastic = metal(0.0f, 0.0f);
    plastic.metallic = 0.0f;
    scene->add_material(plastic);
    scene->add_material(diffuse(1.0f));
    lightcull::RandomStream random(8);
    const auto any = [&] { return 2.0f * random.next() - 1.0f; };
    for (MaterialId material = 0; material < 3; ++material) {
        Shape shape;
        shape.add_sphere({any(), any(), any()}, 0.8f, 12);
        shape.add_level_square({0, -1.0f, 0}, 3.0f, true);
        shape.add_quad({-1, 0, 0}, {1, 1e-7f, 0}, {1, 1e-7f, 1e-6f}, {1, 0, 0});
        shape.add_quad({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0});
        std::vector<float3> normals;
        for (std::size_t i = 0; i < shape.positions.size(); ++i) {
            normals.push_back({any(), any(), any()});
        }
        Emission e = emission(1e6f);
        e.two_sided = material == 1;
        std::vector<float3> powers(shape.indices.size() / 3);
        for (float3& p : powers) p = random.next() < 0.1f ? float3{1, 1e-20f, 1} : float3{};
        e.face_radiance = powers;
        Mesh mesh = shape.mesh("shape", material, e);
        mesh.normals = normals;
        scene->add_mesh(mesh);
    }
    scene->add_point_light({0, -1, 0}, {1, 1, 1});
    Texture sky{8, 4, std::vector<float3>(32)};
    sky.texels[9] = {1e9f, 1e9f, 1e9f};
    scene->set_environment({sky, {1, 1, 1}, 0.3f});
    scene->set_camera(look({0, 0.5f, 3}, {0, 0, 0}, 1.0f));
    scene->commit();
    for (const auto technique : {DirectLight::kLights, DirectLight::kBsdf, DirectLight::kMis}) {
        for (const char* sampler : {"uniform", "light_bvh", "culled", "paper", "exhaustive"}) {
            RenderSettings settings = square_image(48, 12);
            settings.direct_light = technique;
            int wrong = 0;
            for (const float3 p : render(scene, settings, sampler, 8)) {
                for (const float x : {p.x, p.y, p.z}) {
                    wrong += std::isfinite(x) && x >= 0.0f ? 0 : 1;
                }
            }
            CAPTURE(sampler);
            CHECK(wrong == 0);
        }
    }
}
