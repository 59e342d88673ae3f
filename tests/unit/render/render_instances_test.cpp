#include "unit/render/render_support.h"

#include <doctest/doctest.h>
#include <lightcull/error.h>
#include <lightcull/render/preview.h>
#include <lightcull/render/scene_contents.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

using namespace render_support;

namespace {

/// Turned about +Y, stretched, mirrored in x or not, and moved.
Placement placed(double angle, float stretch, bool mirrored, float3 to) {
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    const float m = mirrored ? -1.0f : 1.0f;
    return {{{m * c, 0, s, to.x}, {0, stretch, 0, to.y}, {-m * s, 0, c, to.z}}};
}

std::vector<Placement> placements(std::uint32_t count) {
    std::vector<Placement> all;
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t column = i % 5, row = i / 5;
        const auto x = static_cast<float>(column), z = static_cast<float>(row);
        all.push_back(placed(0.7 * i, 0.6f + 0.1f * x, i % 2 == 1,
                             {1.2f * x - 2.4f, 0.55f, 1.2f * z - 1.2f}));
    }
    return all;
}

float3 at(const Placement& p, float3 a) {
    const auto row = [&](int k) {
        return p.rows[k][0] * a.x + p.rows[k][1] * a.y + p.rows[k][2] * a.z + p.rows[k][3];
    };
    return {row(0), row(1), row(2)};
}

/// A ball with its normals, of which one side is cut out by chance.
struct Ball {
    explicit Ball(std::uint32_t rows) {
        shape.add_sphere({0, 0, 0}, 0.5f, rows);
        for (const float3 p : shape.positions) normals.push_back({2 * p.x, 2 * p.y, 2 * p.z});
    }
    Mesh mesh() const {
        Mesh m = shape.mesh("ball", 1);
        m.normals = normals;
        return m;
    }

    Shape shape;
    std::vector<float3> normals;
};

/// The ball where `p` has it, as a mesh of its own.
Ball moved(const Ball& ball, const Placement& p) {
    Ball result = ball;
    const float(&r)[3][4] = p.rows;
    const float stretch = r[1][1];
    for (float3& a : result.shape.positions) a = at(p, a);
    for (float3& n : result.normals) {
        // The inverse transposed of a turn and a stretch along y.
        const float3 turned =
            at({{{r[0][0], 0, r[0][2], 0}, {0, 1 / stretch, 0, 0}, {r[2][0], 0, r[2][2], 0}}}, n);
        const float length =
            std::sqrt(turned.x * turned.x + turned.y * turned.y + turned.z * turned.z);
        n = {turned.x / length, turned.y / length, turned.z / length};
    }
    const bool mirrored = r[0][0] * r[2][2] - r[0][2] * r[2][0] < 0.0f;
    for (std::size_t i = 0; mirrored && i < result.shape.indices.size(); i += 3) {
        std::swap(result.shape.indices[i], result.shape.indices[i + 2]);
    }
    return result;
}

/// Balls on a floor under lamps, with a sky; shared: one mesh for all of them.
std::shared_ptr<Scene> balls(std::uint32_t rows, std::uint32_t count, bool shared,
                             const Material& of_balls) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.6f));
    scene->add_material(of_balls);
    Shape floor, lamps;
    floor.add_level_square({0, 0, 0}, 4.0f, true);
    lamps.add_level_square({-1, 2.5f, 0}, 0.3f, false);
    lamps.add_level_square({1, 2.2f, 0.5f}, 0.2f, false);
    scene->add_mesh(floor.mesh("floor", 0));
    const Ball ball(rows);
    const MeshId id = shared ? scene->add_shared_mesh(ball.mesh()) : 0;
    for (const Placement& p : placements(count)) {
        if (shared) {
            scene->add_instance(id, p);
        } else {
            scene->add_mesh(moved(ball, p).mesh());
        }
    }
    scene->add_mesh(lamps.mesh("lamps", 0, emission(15.0f)));
    scene->add_point_light({0, 3, 2}, {2, 2, 2});
    scene->set_environment(constant_environment(0.3f));
    scene->set_camera(look({0, 3, 5}, {0, 0.3f, 0}, 0.8f));
    return scene;
}

}  // namespace

TEST_CASE("instances look as meshes of their own do") {
    Material half = diffuse(0.7f);
    half.opacity = 0.5f;
    for (const Material& material : {diffuse(0.7f), metal(0.3f, 0.8f), half}) {
        RenderSettings settings = square_image(32, 4);
        const auto shared = committed(balls(12, 15, true, material));
        const auto apart = committed(balls(12, 15, false, material));
        const auto blocks = [&](const std::shared_ptr<const Scene>& scene) {
            return render_blocks(scene, settings, make_scene_sampler("power", *scene, settings), 96,
                                 8);
        };
        const auto of_shared = blocks(shared);
        settings.seed = 1;
        const auto of_apart = blocks(apart);
        CHECK(shared->triangle_count() == apart->triangle_count());
        // 51 comparisons: a false alarm in some 2,000 runs, were the seeds not fixed.
        CHECK(statistics::worst_p(of_shared, of_apart) > 1e-5);
    }
}

TEST_CASE("instances are cut out independently of each other") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.8f));
    Material half = diffuse(0.0f);
    half.opacity = 0.5f;
    scene->add_material(half);
    Shape floor, pane;
    floor.add_level_square({0, 0, 0}, 4.0f, true);
    pane.add_level_square({0, 0, 0}, 4.0f, true);
    scene->add_mesh(floor.mesh("floor", 0));
    const MeshId shared = scene->add_shared_mesh(pane.mesh("pane", 1));
    for (const float y : {1.0f, 2.0f}) scene->add_instance(shared, placed(0, 1, false, {0, y, 0}));
    scene->add_directional_light({0, -1, 0}, {1, 1, 1});
    scene->set_camera(look({0, 0.5f, 0}, {0, 0, 0}, 0.5f, {1, 0, 0}));
    // A quarter of the light comes through two panes. 32,768 samples: some 8 standard errors.
    const double mean = render_mean(committed(scene), square_image(16, 2), "uniform", 128).mean;
    CHECK(std::fabs(mean * kPi / 0.8 - 0.25) < 0.02);
}

TEST_CASE("instances take the memory of their transforms") {
    const auto memory = [](std::uint32_t count, bool shared) {
        const auto scene = balls(64, count, shared, diffuse(0.7f));
        scene->commit();
        return scene->memory_size();
    };
    const SceneMemory one = memory(1, true), fifteen = memory(15, true), apart = memory(15, false);
    CHECK(fifteen.data - one.data <= std::size_t{14} * 128);
    CHECK(fifteen.bvh < one.bvh + 14 * 4096);
    CHECK(apart.data > 10 * fifteen.data);
    CHECK(apart.bvh > 5 * fifteen.bvh);
}

TEST_CASE("no ray starts below an instance, however large its coordinates are") {
    for (const float away : {0.0f, 1000.0f}) {
        auto scene = std::make_shared<Scene>();
        scene->add_material(diffuse(1.0f));
        scene->add_material(diffuse(1.0f));
        Ball ball(24);
        for (float3& p : ball.shape.positions) p.x += away;  // which the placement takes back
        const MeshId id = scene->add_shared_mesh(ball.mesh());
        scene->add_instance(
            id, placed(0.3, 1.5f, false, {-away * std::cos(0.3f), 0, away * std::sin(0.3f)}));
        scene->set_environment(constant_environment(1.0f));
        scene->set_camera(look({0, 0, 3}, {0, 0, 0}, 0.2f));
        // A white ball in white surroundings cannot be told from them.
        const auto mean = render_mean(committed(scene), square_image(16, 8), "power", 64);
        CHECK(mean.mean == doctest::Approx(1.0).epsilon(0.01));
    }
}

TEST_CASE("instances are previewed, handed on, and stay when others move") {
    auto scene = balls(12, 4, true, diffuse(0.7f));
    const Preview preview(*scene);
    const std::vector<float3> from{{-2.4f, 5, -1.2f}}, down{{0, -1, 0}};
    CHECK(preview.distances(from, down)[0] == doctest::Approx(5.0 - 0.55 - 0.3).epsilon(1e-4));
    scene->commit();
    const SceneContents contents = contents_of(*scene);
    CHECK(contents.meshes.size() == 6);
    const std::vector<float3>& of_second = contents.meshes[3].positions;
    CHECK(of_second[0].y == doctest::Approx(0.55 + 0.7 * 0.5));
    CHECK_THROWS_WITH_AS(scene->set_mesh_positions(1, contents.meshes[2].positions),
                         "mesh 1 is shared: instances of it stay where they are", Error);
    Shape floor;
    floor.add_level_square({0, -1, 0}, 4.0f, true);
    scene->set_mesh_positions(0, floor.positions);
    for (int i = 0; i < 2; ++i) {
        scene->refit();
        const auto seen = pixel_points(*scene, square_image(9, 1));
        int balls_seen = 0, floor_seen = 0;
        for (const auto& point : seen) {
            balls_seen += point && point->position.y > 0.1f ? 1 : 0;
            floor_seen += point && point->position.y == doctest::Approx(-1.0f) ? 1 : 0;
        }
        CHECK(balls_seen > 0);
        CHECK(floor_seen > 20);
        scene->set_mesh_positions(0, floor.positions);
    }
}

TEST_CASE("what cannot be placed is refused by name") {
    Scene scene;
    scene.add_material(diffuse(0.5f));
    scene.add_material(diffuse(0.5f));
    const Ball ball(4);
    const MeshId alone = scene.add_mesh(ball.mesh());
    const MeshId shared = scene.add_shared_mesh(ball.mesh());
    const Placement here = placed(0, 1, false, {0, 0, 0});
    CHECK_THROWS_WITH_AS(scene.add_instance(alone, here), "instance 0: mesh is not a shared one",
                         Error);
    CHECK_THROWS_AS(scene.add_instance(7, here), Error);
    CHECK_THROWS_WITH_AS(scene.add_instance(shared, placed(0, 0, false, {0, 0, 0})),
                         "instance 0: placement makes the mesh flat", Error);
    CHECK_THROWS_AS(scene.add_instance(shared, placed(0, 1, false, {std::nanf(""), 0, 0})), Error);
    Mesh glowing = ball.mesh();
    glowing.emission = emission(1.0f);
    CHECK_THROWS_AS(scene.add_shared_mesh(glowing), Error);
    scene.add_instance(shared, here);
    CHECK(scene.triangle_count() == 2 * ball.shape.indices.size() / 3);
}
