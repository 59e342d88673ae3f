#include "base/random.h"
#include "render/emitter.h"
#include "render/scene_data.h"
#include "unit/render/render_support.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// Emissive triangles that are cut into several lights, and into pieces where their texture is
/// uneven.

using namespace render_support;
using lightcull::EmitterSample;
using lightcull::RandomStream;
using lightcull::TriangleEmitter;
using lightcull::V2f;
using lightcull::V3d;
using lightcull::V3f;
using statistics::Estimate;

namespace {

constexpr const char* kSamplers[] = {"uniform", "power",   "light_bvh",
                                     "culled",  "learned", "exhaustive"};

/// A texture that is black but for some texels.
Texture black(std::uint32_t edge) {
    return {edge, edge, std::vector<float3>(std::size_t{edge} * edge)};
}

Texture one_texel() {
    Texture texture = black(64);
    texture.texels[20 * 64 + 33] = {1000, 1000, 1000};
    return texture;
}

Texture square_of_texels() {
    Texture texture = black(64);
    for (std::size_t y = 16; y < 32; ++y) {
        for (std::size_t x = 16; x < 32; ++x) texture.texels[y * 64 + x] = {1000, 1000, 1000};
    }
    return texture;
}

Texture noise() {
    Texture texture = black(16);
    RandomStream random(2);
    for (float3& texel : texture.texels) {
        const float value = random.next() < 0.5f ? 0.0f : std::exp(4.0f * random.next());
        texel = {value, 0.5f * value, value};
    }
    return texture;
}

/// A floor of 2 * half_edge that a camera fills the image with.
std::shared_ptr<Scene> floor_scene(float half_edge, float height,
                                   const Material& material = diffuse(0.5f)) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(material);
    scene->add_material(diffuse(0.0f));
    Shape floor;
    floor.add_level_square({0, 0, 0}, half_edge, true);
    scene->add_mesh(floor.mesh("floor", 0));
    scene->set_camera(
        look({0, height, 0}, {0, 0, 0}, 2.0f * std::atan(half_edge / height), {0, 0, -1}));
    return scene;
}

/// Adds a rectangle that shines down.
void add_panel(Scene& scene, float3 center, float half_x, float half_z, const Emission& emission) {
    const auto [x, y, z] = center;
    Shape panel;
    panel.add_quad({x - half_x, y, z - half_z}, {x + half_x, y, z - half_z},
                   {x + half_x, y, z + half_z}, {x - half_x, y, z + half_z});
    const std::vector<float2> uvs{{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    Mesh mesh = panel.mesh("panel", 1, emission);
    if (emission.texture != kNoTexture) mesh.uvs = uvs;
    scene.add_mesh(mesh);
}

std::shared_ptr<const Scene> textured(Texture texture, float3 center, float half_edge,
                                      const Material& floor = diffuse(0.5f)) {
    auto scene = floor_scene(4.0f, 2.3f, floor);
    Emission e = emission(1.0f);
    e.texture = scene->add_texture(std::move(texture));
    add_panel(*scene, center, half_edge, half_edge, e);
    return committed(scene);
}

/// A strip of two triangles, 10 cm wide, beside 400 dim lamps.
std::shared_ptr<const Scene> strip(float half_length) {
    auto scene = floor_scene(15.0f, 2.9f);
    add_panel(*scene, {0, 3, 0}, half_length, 0.05f, emission(20.0f));
    RandomStream random(0);
    for (int i = 0; i < 400; ++i) {
        const float x = 30.0f * random.next() - 15.0f, z = 30.0f * random.next() - 15.0f;
        scene->add_point_light({x, 2.95f + 0.5f * random.next(), z}, {0.02f, 0.02f, 0.02f});
    }
    return committed(scene);
}

/// A panel so low that most of the floor sees it under a large angle.
std::shared_ptr<const Scene> low_panel(const Material& floor, bool two_sided) {
    auto scene = floor_scene(4.0f, 0.2f, floor);
    Emission e = emission(1.0f);
    e.two_sided = two_sided;
    add_panel(*scene, {0, 0.3f, 0}, 3.9f, 3.9f, e);
    return committed(scene);
}

/// The variance of a sample over mean^2, mean over the pixels.
double relative_variance(const std::shared_ptr<const Scene>& scene, const std::string& sampler,
                         std::uint32_t passes) {
    const RenderSettings settings = square_image(24, 2);
    const auto pixels =
        render_blocks(scene, settings, make_scene_sampler(sampler, *scene, settings), passes, 1);
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < pixels.size(); ++i) {
        sum += passes * pixels[i].variance / (pixels[i].mean * pixels[i].mean);
    }
    return sum / static_cast<double>(pixels.size() - 1);
}

RenderSettings settings_of(DirectLight technique, std::uint64_t seed) {
    RenderSettings settings = square_image(16, 2);
    settings.direct_light = technique;
    settings.seed = seed;
    return settings;
}

std::vector<Estimate> blocks(const std::shared_ptr<const Scene>& scene,
                             const RenderSettings& settings, std::unique_ptr<LightSampler> sampler,
                             std::uint32_t passes) {
    return render_blocks(scene, settings, std::move(sampler), passes, 8);
}

bool agree(const std::vector<Estimate>& a, const std::vector<Estimate>& b) {
    return statistics::worst_p(a, b) > statistics::least_p();
}

double relative_error(const std::vector<Estimate>& blocks) {
    return std::sqrt(blocks.back().variance) / blocks.back().mean;
}

/// A sampler that takes all lights of a triangle for the first of them, when it is asked for the
/// probability of one.
class FirstPartSampler final : public ForwardingSampler {
  public:
    using ForwardingSampler::ForwardingSampler;
    using ForwardingSampler::prob;
    float prob(const ShadingPoint& point, const Receipt& receipt,
               std::uint32_t) const noexcept override {
        return ForwardingSampler::prob(point, receipt, 0);
    }
};

/// The barycentric coordinates of a place in a triangle of a scene.
float2 barycentric(const lightcull::SceneData& scene, std::uint32_t triangle, const V3f& place) {
    const V3d a(scene.positions[scene.corner(triangle, 0)]);
    const V3d b(scene.positions[scene.corner(triangle, 1)]);
    const V3d c(scene.positions[scene.corner(triangle, 2)]);
    const V3d normal = (b - a).cross(c - a), at = V3d(place) - a;
    return {static_cast<float>(normal.dot(at.cross(c - a)) / normal.dot(normal)),
            static_cast<float>(normal.dot((b - a).cross(at)) / normal.dot(normal))};
}

}  // namespace

TEST_CASE("cut emitters: a hit finds the light and the density by which its place is chosen") {
    for (const auto& scene :
         {low_panel(diffuse(0.5f), true), strip(15.0f), textured(noise(), {0, 3, 0}, 2.0f),
          textured(square_of_texels(), {0, 0.5f, 0}, 2.0f)}) {
        const lightcull::SceneData& data = data_of(*scene);
        REQUIRE(data.lights.size() > 2);
        RandomStream random(4);
        int compared = 0;
        for (std::uint32_t light = 0; light < data.lights.size(); ++light) {
            if (!(data.lights[light].intensity > 0.0f)) continue;
            const auto* const emitter = std::get_if<TriangleEmitter>(&data.emitters[light]);
            if (emitter == nullptr) continue;
            for (int i = 0; i < 200; ++i) {
                const float x = 8.0f * random.next() - 4.0f, z = 8.0f * random.next() - 4.0f;
                const V3f from(x, 0.0f, z);
                const auto piece = static_cast<double>(random.next());
                const float u = random.next();
                const EmitterSample s = sample_emitter(data, data.emitters[light], from,
                                                       {piece, V2f(u, random.next())});
                REQUIRE(s.pdf > 0.0f);
                const float2 place = barycentric(data, emitter->triangle, s.place);
                const std::uint32_t first = data.triangles[emitter->triangle].light;
                const auto found = place_pdf(data, first, place, from, s.place - from);
                // Rounding decides at edges.
                if (found.light != light) continue;
                if (std::fabs(found.pdf / s.pdf - 1.0f) < 1e-2f) ++compared;
            }
        }
        const auto all = std::count_if(data.lights.begin(), data.lights.end(), [](const Light& l) {
            return l.intensity > 0.0f && l.radius > 0.0f;
        });
        CHECK(compared > 0.99 * 200.0 * static_cast<double>(all));
    }
}

TEST_CASE("cut emitters: the lights of a triangle emit all that it does") {
    const auto panel = low_panel(diffuse(0.5f), false);
    double sum = 0.0;
    for (const Light& light : panel->lights()) sum += static_cast<double>(light.intensity);
    CHECK(panel->lights().size() > 100);
    CHECK(sum == doctest::Approx(4.0 * 3.9 * 3.9).epsilon(1e-5));

    const auto texel = textured(one_texel(), {0, 3, 0}, 2.0f);
    sum = 0.0;
    for (const Light& light : texel->lights()) sum += static_cast<double>(light.intensity);
    CHECK(texel->lights().size() < 20);
    CHECK(sum == doctest::Approx(1000.0 * 4.0 * 4.0 / (64.0 * 64.0)).epsilon(1e-5));
}

TEST_CASE("cut emitters: a lamp that has next to nothing of its texture shines all the same") {
    auto scene = floor_scene(4.0f, 2.3f);
    Texture white = black(1024);
    std::fill(white.texels.begin(), white.texels.end(), float3{1, 1, 1});
    Emission e = emission(1.0f);
    e.texture = scene->add_texture(std::move(white));
    Shape panel;
    panel.add_quad({-2, 1, -2}, {2, 1, -2}, {2, 1, 2}, {-2, 1, 2});
    Mesh mesh = panel.mesh("panel", 1, e);
    const std::vector<float2> uvs{
        {0.3f, 0.3f}, {0.300001f, 0.3f}, {0.300001f, 0.300001f}, {0.3f, 0.300001f}};
    mesh.uvs = uvs;
    scene->add_mesh(mesh);
    double sum = 0.0;
    for (const Light& light : committed(scene)->lights()) {
        sum += static_cast<double>(light.intensity);
    }
    CHECK(sum == doctest::Approx(4.0 * 4.0).epsilon(1e-4));
}

TEST_CASE("cut emitters: what is small or far, or one of very many lamps, is not cut") {
    auto scene = floor_scene(4.0f, 2.3f);
    for (int i = 0; i < 9; ++i) {
        const int row = i / 3;
        add_panel(*scene, {static_cast<float>(i % 3), 3, static_cast<float>(row)}, 0.3f, 0.3f,
                  emission(1.0f));
    }
    CHECK(committed(scene)->lights().size() == 18);

    scene = floor_scene(100.0f, 0.09f);
    for (int i = 0; i < 4096; ++i) {
        const int row = i / 64;
        add_panel(*scene, {static_cast<float>(i % 64), 0.1f, static_cast<float>(row)}, 0.3f, 0.3f,
                  emission(1.0f));
    }
    CHECK(committed(scene)->lights().size() == 8192);
}

TEST_CASE("cut emitters: a sun far away does not keep near lamps whole") {
    const auto with_panel = [] {
        auto scene = floor_scene(4.0f, 0.2f);
        add_panel(*scene, {0, 0.3f, 0}, 3.9f, 3.9f, emission(1.0f));
        for (int i = 0; i < 50; ++i) scene->add_point_light({0, 0.1f, 0}, {0.01f, 0.01f, 0.01f});
        return scene;
    };
    const auto scene = with_panel();
    const std::size_t lights = committed(with_panel())->lights().size();
    add_panel(*scene, {0, 1e8f, 0}, 1e6f, 1e6f, emission(1e4f));
    CHECK(lights > 100);
    CHECK(committed(scene)->lights().size() == lights + 2);
}

TEST_CASE(
    "cut emitters: lights keep the places in which they were added, further parts come last") {
    auto scene = floor_scene(4.0f, 0.2f);
    scene->add_point_light({0, 1, 0}, {1, 1, 1});
    add_panel(*scene, {0, 0.3f, 0}, 3.9f, 3.9f, emission(1.0f));
    scene->add_point_light({0, 2, 0}, {1, 1, 1});
    scene->commit();
    const Span<const Light> lights = scene->lights();
    REQUIRE(lights.size() > 100);
    CHECK(lights[0].center.y == 1.0f);
    CHECK(lights[3].center.y == 2.0f);
    for (std::size_t i = 4; i < lights.size(); ++i) CHECK(lights[i].center.y == 0.3f);
}

TEST_CASE("cut emitters: light sampling, BSDF sampling and both agree in the mean") {
    const Material shiny = gloss(0.5f);
    for (const auto& scene :
         {low_panel(shiny, false), textured(noise(), {0, 2.5f, 0}, 3.0f, shiny)}) {
        const auto by_bsdf =
            blocks(scene, settings_of(DirectLight::kBsdf, 1),
                   make_scene_sampler("uniform", *scene, settings_of(DirectLight::kBsdf, 1)), 3000);
        CHECK(relative_error(by_bsdf) < 0.004);
        for (const std::string sampler : kSamplers) {
            CAPTURE(sampler);
            // These two do not know which part is near.
            const double most = sampler == "uniform" || sampler == "power" ? 0.03 : 0.006;
            for (const DirectLight technique : {DirectLight::kLights, DirectLight::kMis}) {
                const RenderSettings settings = settings_of(technique, 2);
                const auto estimates =
                    blocks(scene, settings, make_scene_sampler(sampler, *scene, settings), 600);
                CHECK(agree(estimates, by_bsdf));
                CHECK(relative_error(estimates) < most);
            }
        }
        // One for which all parts are the first must be caught.
        const RenderSettings settings = settings_of(DirectLight::kMis, 3);
        auto first =
            std::make_unique<FirstPartSampler>(make_scene_sampler("light_bvh", *scene, settings));
        CHECK_FALSE(agree(blocks(scene, settings, std::move(first), 600), by_bsdf));
    }
}

TEST_CASE("cut emitters: a strip over a floor, many times as long as it is high above it") {
    for (const float half_length : {15.0f, 50.0f}) {
        const auto scene = strip(half_length);
        CAPTURE(half_length);
        CHECK(scene->lights().size() > 440);
        for (const std::string sampler : {"learned", "exhaustive"}) {
            CAPTURE(sampler);
            CHECK(relative_variance(scene, sampler, 64) < 0.1);
        }
    }
}

TEST_CASE("cut emitters: bright texels of a black panel are as good as triangles") {
    struct Case {
        Texture texture;
        float3 center;
        float half_edge;
    };
    for (const Case& c : {Case{one_texel(), {0.09375f, 3, -0.71875f}, 0.03125f},
                          Case{square_of_texels(), {-0.5f, 3, -0.5f}, 0.5f}}) {
        auto scene = floor_scene(4.0f, 2.3f);
        add_panel(*scene, c.center, c.half_edge, c.half_edge, emission(1000.0f));
        const auto triangles = committed(scene);
        const auto texels = textured(c.texture, {0, 3, 0}, 2.0f);
        const RenderSettings settings = settings_of(DirectLight::kMis, 5);
        const Estimate of_triangles = render_mean(triangles, settings);
        const Estimate of_texels = render_mean(texels, settings);
        // The texels' edges are soft, which takes 1e-4 of the light elsewhere.
        CHECK(of_texels.mean == doctest::Approx(of_triangles.mean).epsilon(2e-3));
        for (const std::string sampler : kSamplers) {
            if (sampler == "uniform") continue;  // lights of unlike power
            CAPTURE(sampler);
            // Triangles do better with fewer last rays (0.0207 in place of 0.024 by light_bvh,
            // whose bounds say nothing of the distance of near lights), and texels are what they
            // were.
            const double times = sampler == "light_bvh" ? 2.1 : 2.0;
            const double exact = relative_variance(triangles, sampler, 64);
            CHECK(relative_variance(texels, sampler, 64) < times * exact + 2e-4);
        }
    }
}

TEST_CASE("cut emitters: many bright texels") {
    Texture texture = black(64);
    for (std::size_t i = 0; i < texture.texels.size(); ++i) {
        if (i % 4 == 0 && i / 64 % 4 == 0) texture.texels[i] = {20, 20, 20};
    }
    const auto scene = textured(std::move(texture), {0, 3, 0}, 2.0f);
    CHECK(relative_variance(scene, "learned", 64) < 0.1);
    CHECK(relative_variance(scene, "exhaustive", 64) < 0.1);
}
