#include "base/float3_math.h"
#include "base/random.h"
#include "render/scene_data.h"
#include "unit/render/render_support.h"

#include <lightcull/error.h>
#include <lightcull/virtual_lights/scene_virtual_lights.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// Scenes in which things move are those that would be built there.

using namespace render_support;
using lightcull::RandomStream;
using lightcull::TriangleEmitter;
using statistics::Estimate;

namespace {

/// What moves in a scene: an angle and a way.
struct Pose {
    float turn = 0.0f;  ///< radians about +Y
    float3 shift{0, 0, 0};

    float3 direction(float3 d) const {
        const float c = std::cos(turn), s = std::sin(turn);
        return {c * d.x + s * d.z, d.y, c * d.z - s * d.x};
    }
    float3 position(float3 p) const { return direction(p) + shift; }
    std::vector<float3> positions(const std::vector<float3>& from) const {
        std::vector<float3> moved;
        moved.reserve(from.size());
        for (const float3 p : from) moved.push_back(position(p));
        return moved;
    }
};

/// A floor, a ball with shading normals, lamps with and without a texture, points, spots and a sun:
/// all but the floor in a pose.
class Stage {
  public:
    enum : MeshId { kFloor, kBall, kLamps, kPanel };

    Stage() {
        floor_.add_level_square({0, 0, 0}, 4.0f, true);
        ball_.add_sphere({0.3f, 0.7f, 0.2f}, 0.4f, 6);
        for (const float3 p : ball_.positions) normals_.push_back(p - float3{0.3f, 0.7f, 0.2f});
        RandomStream random(7);
        for (int i = 0; i < 40; ++i) {
            const float x = 6.0f * random.next() - 3.0f, z = 6.0f * random.next() - 3.0f;
            lamps_.add_level_square({x, 2.0f + random.next(), z}, 0.05f, false);
        }
        panel_.add_level_square({1.0f, 2.5f, -1.0f}, 0.2f, false);
        points_ = {{-1, 1.5f, 0}, {0.5f, 2.5f, 1.5f}, {2, 2, 2}};
        directions_ = {{0.2f, -3, 0.1f}, {0.4f, -1, -0.3f}};
    }

    std::shared_ptr<Scene> build(const Pose& pose) const {
        auto scene = std::make_shared<Scene>();
        scene->add_material(diffuse(0.6f));
        scene->add_material(gloss(0.4f));
        scene->add_mesh(floor_.mesh("floor", 0));
        add(*scene, ball_, pose, emission(0.0f), 1);
        Emission of_lamps = emission(9.0f);
        of_lamps.two_sided = true;
        add(*scene, lamps_, pose, of_lamps, 0);
        Emission of_panel = emission(20.0f);
        of_panel.texture = scene->add_texture({2, 1, {{1, 0.5f, 0}, {0.2f, 0.2f, 0.2f}}});
        add(*scene, panel_, pose, of_panel, 0);
        scene->add_point_light(pose.position(points_[0]), {1, 0.5f, 2});
        scene->add_spot_light(pose.position(points_[1]), pose.direction(directions_[0]), {9, 9, 9},
                              0.3f, 0.7f);
        scene->add_directional_light(pose.direction(directions_[1]), {0.2f, 0.2f, 0.1f});
        scene->add_point_light(pose.position(points_[2]), {2, 1, 1});
        scene->set_camera(look({4, 2.5f, 5}, {0, 0.8f, 0}, 0.8f));
        scene->commit();
        return scene;
    }

    void move(Scene& scene, const Pose& pose) const {
        std::vector<float3> normals;
        for (const float3 n : normals_) normals.push_back(pose.direction(n));
        scene.set_mesh_positions(kBall, pose.positions(ball_.positions), normals);
        scene.set_mesh_positions(kLamps, pose.positions(lamps_.positions));
        scene.set_mesh_positions(kPanel, pose.positions(panel_.positions));
        scene.set_light_positions(pose.positions(points_));
        std::vector<float3> directions;
        for (const float3 d : directions_) directions.push_back(pose.direction(d));
        scene.set_light_directions(directions);
    }

    /// The lamps, strewn about anew so that no two that lay together still do.
    void strew(Scene& scene) const {
        std::vector<float3> positions = lamps_.positions;
        RandomStream random(8);
        for (float3& p : positions) {
            p = p + float3{500.0f * random.next(), 500.0f * random.next(), 500.0f * random.next()};
        }
        scene.set_mesh_positions(kLamps, positions);
    }

  private:
    void add(Scene& scene, const Shape& shape, const Pose& pose, const Emission& emission,
             MaterialId material) const {
        const std::vector<float3> positions = pose.positions(shape.positions);
        std::vector<float3> normals;
        Mesh mesh = shape.mesh("part", material, emission);
        mesh.positions = positions;
        if (&shape == &ball_) {
            for (const float3 n : normals_) normals.push_back(pose.direction(n));
            mesh.normals = normals;
        }
        const std::vector<float2> uvs{{0, 1}, {1, 1}, {1, 0}, {0, 0}};
        if (emission.texture != kNoTexture) mesh.uvs = uvs;
        scene.add_mesh(mesh);
    }

    Shape floor_, ball_, lamps_, panel_;
    std::vector<float3> normals_, points_, directions_;
};

constexpr Pose kPoses[] = {
    {0.1f, {0.3f, 0.1f, -0.2f}}, {0.0f, {0, 0, 0}}, {0.7f, {-0.5f, 0.2f, 0}}};

bool same_bits(const Light& a, const Light& b) {
    const auto numbers = [](const Light& light) {
        const float3 center = light.center, axis = light.axis;
        return std::array{center.x,     center.y,       center.z,          axis.x,
                          axis.y,       axis.z,         light.cos_theta_o, light.cos_theta_e,
                          light.radius, light.intensity};
    };
    const auto of_a = numbers(a), of_b = numbers(b);
    return std::memcmp(of_a.data(), of_b.data(), sizeof of_a) == 0 && a.two_sided == b.two_sided &&
           a.directional == b.directional;
}

bool same_lights(const Scene& a, const Scene& b) {
    return std::equal(a.lights().begin(), a.lights().end(), b.lights().begin(), b.lights().end(),
                      same_bits);
}

/// The part of the pixels that differ by more than rounding.
double differing(const std::vector<float3>& a, const std::vector<float3>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double of_a = luminance(a[i]), of_b = luminance(b[i]);
        if (std::fabs(of_a - of_b) > 1e-5 * std::max(of_a, of_b)) ++count;
    }
    return static_cast<double>(count) / static_cast<double>(a.size());
}

std::vector<float3> image_of(Renderer& renderer, int passes) {
    for (int i = 0; i < passes; ++i) renderer.render_pass();
    return renderer.image();
}

/// A long strip right above a floor, with a texture or without, in a pose.
std::shared_ptr<Scene> strip_scene(const Pose& pose, bool textured) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape floor, strip;
    floor.add_level_square({0, 0, 0}, 6.0f, true);
    strip.add_quad({-3, 0.6f, -0.1f}, {3, 0.6f, -0.1f}, {3, 0.6f, 0.1f}, {-3, 0.6f, 0.1f});
    scene->add_mesh(floor.mesh("floor", 0));
    Emission e = emission(5.0f);
    const std::vector<float2> uvs{{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    Mesh mesh = strip.mesh("strip", 0, e);
    if (textured) {
        Texture texture{8, 1, std::vector<float3>(8)};
        texture.texels[2] = {9, 9, 9};
        texture.texels[7] = {1, 2, 3};
        mesh.uvs = uvs;
        mesh.emission.texture = scene->add_texture(std::move(texture));
    }
    const std::vector<float3> positions = pose.positions(strip.positions);
    mesh.positions = positions;
    scene->add_mesh(mesh);
    scene->set_camera(look({0, 4, 6}, {0, 0, 0}, 1.0f));
    scene->commit();
    return scene;
}

void move_strip(Scene& scene, const Pose& pose) {
    Shape strip;
    strip.add_quad({-3, 0.6f, -0.1f}, {3, 0.6f, -0.1f}, {3, 0.6f, 0.1f}, {-3, 0.6f, 0.1f});
    scene.set_mesh_positions(1, pose.positions(strip.positions));
    scene.refit();
}

RenderSettings settings_of(DirectLight technique, std::uint64_t seed) {
    RenderSettings settings = square_image(16, 2);
    settings.direct_light = technique;
    settings.seed = seed;
    return settings;
}

bool agree(const std::vector<Estimate>& a, const std::vector<Estimate>& b) {
    return statistics::worst_p(a, b) > statistics::least_p();
}

}  // namespace

TEST_CASE("moved scenes: lights are those of a scene that is built there, to the bit") {
    const Stage stage;
    const auto scene = stage.build({});
    for (const Pose& pose : kPoses) {
        stage.move(*scene, pose);
        scene->refit();
        const auto built = stage.build(pose);
        REQUIRE(scene->lights().size() == 40 * 2 + 2 + 4);
        CHECK(same_lights(*scene, *built));
    }
    CHECK_FALSE(same_lights(*scene, *stage.build({})));
}

TEST_CASE("moved scenes: images are those of a scene that is built there, to rounding") {
    // These samplers depend on nothing but the lights.
    const Stage stage;
    const RenderSettings settings = square_image(40, 3);
    for (const char* const sampler : {"power", "exhaustive"}) {
        CAPTURE(sampler);
        const auto scene = stage.build({});
        Renderer renderer(scene, settings, make_scene_sampler(sampler, *scene, settings));
        const std::vector<float3> at_first = image_of(renderer, 4);
        for (const Pose& pose : kPoses) {
            stage.move(*scene, pose);
            scene->refit();
            renderer.restart(5);
            CHECK(renderer.stats().passes == 0);
            RenderSettings other = settings;
            other.seed = 5;
            const auto built = stage.build(pose);
            Renderer anew(built, other, make_scene_sampler(sampler, *built, other));
            const std::vector<float3> moved = image_of(renderer, 4);
            // A ray along an edge may be decided by another order of triangles.
            CHECK(differing(moved, image_of(anew, 4)) < 0.002);
            CHECK(differing(moved, at_first) > 0.5);
        }
    }
}

TEST_CASE("moved scenes: any sampler has the mean of a scene that is built there") {
    const Stage stage;
    const Pose pose = kPoses[2];
    const RenderSettings settings = square_image(16, 2);
    const auto built = stage.build(pose);
    const auto truth =
        render_blocks(built, settings, make_scene_sampler("exhaustive", *built, settings), 400, 4);
    for (const std::string sampler : {"uniform", "light_bvh", "culled", "learned"}) {
        CAPTURE(sampler);
        const auto scene = stage.build({});
        auto fitted = make_scene_sampler(sampler, *scene, settings);
        stage.move(*scene, pose);
        scene->refit();
        fitted->update(scene->lights());
        CHECK(agree(
            render_blocks(scene, settings_of(DirectLight::kMis, 1), std::move(fitted), 400, 4),
            truth));
    }
}

TEST_CASE("moved scenes: lights that are cut move with their triangles") {
    const Pose pose{1.1f, {0.5f, 0.4f, -1.0f}};
    for (const bool textured : {false, true}) {
        CAPTURE(textured);
        const auto scene = strip_scene({}, textured);
        REQUIRE(scene->lights().size() > 4);
        const auto sum_of = [](const Scene& s) {
            double sum = 0.0;
            for (const Light& light : s.lights()) sum += static_cast<double>(light.intensity);
            return sum;
        };
        const double before = sum_of(*scene);
        move_strip(*scene, pose);
        CHECK(sum_of(*scene) == doctest::Approx(before).epsilon(1e-5));

        // Both techniques and a scene that is built there agree: parts are where hits find them.
        const auto built = strip_scene(pose, textured);
        const RenderSettings bsdf = settings_of(DirectLight::kBsdf, 1);
        const auto truth =
            render_blocks(built, bsdf, make_scene_sampler("uniform", *built, bsdf), 4000, 8);
        for (const std::string sampler : {"light_bvh", "learned"}) {
            for (const DirectLight technique : {DirectLight::kLights, DirectLight::kMis}) {
                const RenderSettings settings = settings_of(technique, 2);
                CHECK(agree(render_blocks(scene, settings,
                                          make_scene_sampler(sampler, *scene, settings), 600, 8),
                            truth));
            }
        }
        // It is the old place that is no more.
        const auto old = strip_scene({}, textured);
        CHECK_FALSE(agree(
            render_blocks(old, bsdf, make_scene_sampler("uniform", *old, bsdf), 4000, 8), truth));
    }
}

TEST_CASE("moved scenes: a tree of rays is fitted while it is tight, and built anew when not") {
    const Stage stage;
    const auto scene = stage.build({});
    CHECK(scene->refit().rebuilt);  // as one that can be fitted
    const SceneRefit same = scene->refit();
    CHECK_FALSE(same.rebuilt);
    CHECK(same.growth == 1.0f);
    stage.move(*scene, kPoses[0]);
    const SceneRefit little = scene->refit();
    CHECK_FALSE(little.rebuilt);
    CHECK(little.growth < 1.5f);
    stage.strew(*scene);
    const SceneRefit much = scene->refit();
    CHECK(much.rebuilt);
    CHECK(much.growth > 2.0f);
    const SceneRefit after = scene->refit();
    CHECK_FALSE(after.rebuilt);
    CHECK(after.growth == 1.0f);
    stage.move(*scene, {});
    CHECK_FALSE(scene->refit(1e9f).rebuilt);  // tighter than it was
    CHECK(scene->memory_size().bvh > 0);
}

TEST_CASE("moved scenes: where coordinates leave the range of Embree, its tree is built anew") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape wall;
    wall.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    scene->add_mesh(wall.mesh("wall", 0, emission(1.0f)));
    scene->set_camera(look({0, 0, 3}, {0, 0, 0}, 0.3f));
    scene->commit();
    scene->refit();
    Shape large;
    constexpr float kFar = 1e13f;
    large.add_quad({-kFar, -kFar, 0}, {kFar, -kFar, 0}, {kFar, kFar, 0}, {-kFar, kFar, 0});
    scene->set_mesh_positions(0, large.positions);
    CHECK(scene->refit(1e30f).rebuilt);
    CHECK_FALSE(scene->refit(1e30f).rebuilt);
    const RenderSettings settings = square_image(4, 1);
    CHECK(render_mean(scene, settings, "power", 2).mean == doctest::Approx(1.0));
}

TEST_CASE("moved scenes: what is dark where it is built may shine later") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape floor, lamp;
    floor.add_level_square({0, 0, 0}, 2.0f, true);
    lamp.add_level_square({0, 1, 0}, 0.0f, false);
    scene->add_mesh(floor.mesh("floor", 0));
    scene->add_mesh(lamp.mesh("lamp", 0, emission(3.0f)));
    scene->set_camera(look({0, 3, 0.1f}, {0, 0, 0}, 0.8f));
    scene->commit();
    CHECK(scene->lights()[0].intensity == 0.0f);
    const RenderSettings settings = square_image(8, 2);
    Renderer renderer(scene, settings, make_scene_sampler("culled", *scene, settings));
    Shape larger;
    larger.add_level_square({0, 1, 0}, 0.2f, false);
    scene->set_mesh_positions(1, larger.positions);
    scene->refit();
    CHECK(scene->lights()[0].intensity == doctest::Approx(3.0 * 0.5 * 0.4 * 0.4));
    CHECK(renderer.restart(0).rebuilt);
    double sum = 0.0;
    for (const float3 pixel : image_of(renderer, 4)) sum += luminance(pixel);
    CHECK(sum > 0.0);
}

TEST_CASE("moved scenes: nothing is rendered in between") {
    const Stage stage;
    const auto scene = stage.build({});
    const RenderSettings settings = square_image(8, 2);
    Renderer renderer(scene, settings, make_scene_sampler("culled", *scene, settings));
    renderer.render_pass();
    stage.move(*scene, kPoses[0]);
    const char* const kRefit = "scene: it was moved, and refit() must come before rendering";
    CHECK_THROWS_WITH_AS(renderer.render_pass(), kRefit, Error);
    CHECK_THROWS_WITH_AS(renderer.restart(0), kRefit, Error);
    CHECK_THROWS_WITH_AS(make_scene_sampler("culled", *scene, settings), kRefit, Error);
    scene->refit();
    CHECK_THROWS_WITH_AS(renderer.render_pass(),
                         "renderer: the scene was moved, and restart() must come before rendering",
                         Error);
    CHECK(renderer.stats().passes == 1);
    renderer.restart(0);
    CHECK(renderer.render_pass());
}

TEST_CASE("moved scenes: what makes no sense is named, and changes nothing") {
    const Stage stage;
    const auto scene = stage.build({});
    const std::vector<Light> before(scene->lights().begin(), scene->lights().end());
    const std::vector<float3> four(4, float3{0, 1, 0});
    std::vector<float3> wrong = four;
    wrong[2].y = std::numeric_limits<float>::quiet_NaN();
    constexpr float kTiny = 1e-20f;
    const std::vector<float3> tiny{{0, 0, 0}, {kTiny, 0, 0}, {kTiny, kTiny, 0}, {0, kTiny, 0}};
    const auto refused = [&](auto&& move, const char* message) {
        CHECK_THROWS_WITH_AS(move(), message, Error);
    };
    refused([&] { scene->set_mesh_positions(9, four); },
            "set_mesh_positions: mesh is 9, but there are 4 meshes");
    refused(
        [&] {
            scene->set_mesh_positions(0, {four.data(), 3});
        },
        "mesh 0: positions has 3 elements for 4 corners");
    refused([&] { scene->set_mesh_positions(3, wrong); }, "mesh 3: positions[2] is not finite");
    refused([&] { scene->set_mesh_positions(3, tiny); },
            "mesh 3: triangle 0 emits, and its area is below 6e-39 m^2, which floats do not hold");
    refused([&] { scene->set_mesh_positions(3, four, four); },
            "mesh 3: normals are given, and the mesh was added without");
    refused([&] { scene->set_light_positions(four); },
            "set_light_positions: positions has 4 elements for 3 points and spots");
    refused(
        [&] {
            scene->set_light_positions({wrong.data(), 3});
        },
        "set_light_positions: positions[2] is not finite");
    refused([&] { scene->set_light_directions(four); },
            "set_light_directions: directions has 4 elements for 2 spots and directional lights");
    const std::vector<float3> zero{{1, 0, 0}, {0, 0, 0}};
    refused([&] { scene->set_light_directions(zero); }, "set_light_directions: directions[1] is 0");
    const RenderSettings settings = square_image(4, 2);
    Renderer renderer(scene, settings, make_scene_sampler("power", *scene, settings));
    CHECK(renderer.render_pass());
    CHECK(std::equal(before.begin(), before.end(), scene->lights().begin(), same_bits));

    Scene unbuilt;
    refused([&] { unbuilt.refit(); }, "scene: commit() must come before refit()");
    auto with_virtual = std::make_shared<Scene>();
    with_virtual->add_material(diffuse(0.5f));
    Shape floor;
    floor.add_level_square({0, 0, 0}, 2.0f, true);
    with_virtual->add_mesh(floor.mesh("floor", 0));
    with_virtual->add_point_light({0, 1, 0}, {1, 1, 1});
    add_virtual_lights(*with_virtual, 16, 1, 0);
    refused(
        [&] {
            with_virtual->set_light_positions({four.data(), 1});
        },
        "scene: nothing can be moved, virtual lights are where paths met what was there");
}

TEST_CASE("moved scenes: what is moved before commit() is built where it is") {
    Scene scene;
    scene.add_material(diffuse(0.5f));
    Shape lamp;
    lamp.add_level_square({0, 1, 0}, 0.5f, false);
    scene.add_mesh(lamp.mesh("lamp", 0, emission(3.0f)));
    scene.set_mesh_positions(0, Pose{0, {7, 0, 0}}.positions(lamp.positions));
    scene.commit();
    for (const Light& light : scene.lights())
        CHECK(light.center.x == doctest::Approx(7.0).epsilon(0.1));
    const RenderSettings settings = square_image(4, 2);
    CHECK(make_scene_sampler("culled", scene, settings) != nullptr);
}

TEST_CASE("what is cut out of a mesh moves with it") {
    Scene scene;
    scene.add_material(diffuse(0.5f));
    Material masked = diffuse(0.5f);
    Texture mask;
    mask.width = 2;
    mask.height = 1;
    mask.channels = 1;
    mask.texels8 = {0, 255};
    masked.opacity_texture = scene.add_texture(mask);
    masked.opacity_threshold = 0.5f;
    scene.add_material(masked);
    Shape floor, plates;
    floor.add_level_square({0, 0, 0}, 9.0f, true);
    plates.add_level_square({-1, 1, 0}, 0.5f, true);  // clear
    plates.add_level_square({1, 1, 0}, 0.5f, true);   // not
    scene.add_mesh(floor.mesh("floor", 0));
    Mesh mesh = plates.mesh("plates", 1);
    std::vector<float2> uvs(8, {0.25f, 0.5f});
    std::fill(uvs.begin() + 4, uvs.end(), float2{0.75f, 0.5f});
    mesh.uvs = uvs;
    const MeshId moving = scene.add_mesh(mesh);
    scene.commit();
    for (const bool rebuilt : {true, false, false}) {
        for (float3& p : plates.positions) p.z += 0.8f;
        scene.set_mesh_positions(moving, plates.positions);
        CHECK(scene.refit().rebuilt == rebuilt);
        const auto& tracer = *data_of(scene).ray_tracer;
        const float z = 0.5f * (plates.positions[0].z + plates.positions[2].z) + 0.1f;
        const std::vector<lightcull::Ray> rays{{V3f(-1.1f, 3, z), V3f(0, -1, 0)},
                                               {V3f(0.9f, 3, z), V3f(0, -1, 0)},
                                               {V3f(-1.1f, 3, z), V3f(0, -2.5f, 0), 1.0f},
                                               {V3f(0.9f, 3, z), V3f(0, -2.5f, 0), 1.0f}};
        std::vector<lightcull::Hit> hits(4);
        tracer.intersect({rays.data(), 2}, {hits.data(), 2}, false);
        CHECK(hits[0].triangle < 2);
        CHECK(hits[1].triangle >= 4);
        std::vector<std::uint8_t> hidden(2);
        tracer.occluded({rays.data() + 2, 2}, hidden);
        CHECK(hidden[0] == 0);
        CHECK(hidden[1] == 1);
    }
}
