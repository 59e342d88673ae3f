#include "unit/render/render_support.h"

#include <doctest/doctest.h>
#include <lightcull/error.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

/// Surfaces that rays meet by chance, or by a mask. A black plate of opacity a over the lamp takes
/// the part a of its light.

using namespace render_support;
using statistics::Estimate;

namespace {

/// A square plate with texture coordinates over all of it.
void add_plate(Scene& scene, float y, float half_edge, bool up, MaterialId material,
               const Emission& emission = {}) {
    Shape shape;
    shape.add_level_square({0, y, 0}, half_edge, up);
    const std::vector<float2> uvs{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    Mesh mesh = shape.mesh("plate", material, emission);
    mesh.uvs = uvs;
    scene.add_mesh(mesh);
}

Material black(float opacity) {
    Material m = diffuse(0.0f);
    m.opacity = opacity;
    return m;
}

/// A floor seen from above, at one place, under a lamp at one side of the camera; what `add` adds
/// is between the two.
template <typename Add>
std::shared_ptr<const Scene> floor_below(const Add& add) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.8f));
    Shape floor;
    floor.add_level_square({0, 0, 0}, 5.0f, true);
    scene->add_mesh(floor.mesh("floor", 0));
    add(*scene);
    scene->set_camera(look({0, 0.5f, 2}, {0, 0, 0}, 0.02f));
    return committed(scene);
}

Estimate seen(const std::shared_ptr<const Scene>& scene, DirectLight technique) {
    RenderSettings settings = square_image(16, 2);
    settings.direct_light = technique;
    return render_mean(scene, settings);
}

constexpr DirectLight kAll[] = {DirectLight::kMis, DirectLight::kLights, DirectLight::kBsdf};

void add_lamp(Scene& scene) {
    add_plate(scene, 3.0f, 1.0f, false, 0, emission(10.0f));
}

/// Whether a mean is a part of another one, but for their noise.
bool agree(const Estimate& a, double part, const Estimate& b) {
    const double variance = a.variance + part * part * b.variance;
    const double difference = std::fabs(a.mean - part * b.mean);
    if (!(variance > 0.0)) return difference < 1e-6;
    return statistics::p_of_z(difference / std::sqrt(variance)) > statistics::least_p();
}

}  // namespace

TEST_CASE("cut-outs: of light that falls through a surface, its opacity is lost") {
    const auto open = floor_below(add_lamp);
    for (const float opacity : {0.0f, 0.25f, 0.6f}) {
        const auto through = floor_below([&](Scene& scene) {
            add_lamp(scene);
            add_plate(scene, 2.0f, 5.0f, true, scene.add_material(black(opacity)));
        });
        for (const DirectLight technique : kAll) {
            CAPTURE(opacity);
            CHECK(agree(seen(through, technique), 1.0 - opacity, seen(open, technique)));
        }
    }
}

TEST_CASE("cut-outs: a lamp emits as much as its opacity, by light and by BSDF sampling") {
    const auto whole = floor_below(add_lamp);
    for (const bool by_texture : {false, true}) {
        const auto thin = floor_below([&](Scene& scene) {
            Material m = black(by_texture ? 1.0f : 0.3f);
            if (by_texture) {
                Texture grey;
                grey.width = grey.height = grey.channels = 1;
                grey.is_srgb = false;
                grey.texels8 = {77};  // 77 / 255 is 0.302
                m.opacity_texture = scene.add_texture(grey);
            }
            add_plate(scene, 3.0f, 1.0f, false, scene.add_material(m), emission(10.0f));
        });
        for (const DirectLight technique : kAll) {
            const double opacity = by_texture ? 77.0 / 255.0 : 0.3;
            CHECK(agree(seen(thin, technique), opacity, seen(whole, technique)));
        }
    }
}

TEST_CASE("cut-outs: with a threshold a ray meets what is at least that opaque") {
    // Left half 0.4, right half 0.6.
    const auto masked = [](float threshold) {
        return floor_below([&](Scene& scene) {
            Material m = black(1.0f);
            Texture halves;
            halves.width = 64;
            halves.height = halves.channels = 1;
            halves.is_srgb = false;
            for (int i = 0; i < 64; ++i) halves.texels8.push_back(i < 32 ? 102 : 153);
            m.opacity_texture = scene.add_texture(halves);
            m.opacity_threshold = threshold;
            add_lamp(scene);
            add_plate(scene, 2.999f, 1.0f, true, scene.add_material(m));
        });
    };
    const Estimate open = seen(floor_below(add_lamp), DirectLight::kMis);
    CHECK(agree(seen(masked(0.7f), DirectLight::kMis), 1.0, open));
    CHECK(seen(masked(0.3f), DirectLight::kMis).mean == 0.0);
    // The place below the middle gets half of it, but for the texel in between.
    CHECK(seen(masked(0.5f), DirectLight::kMis).mean ==
          doctest::Approx(0.5 * open.mean).epsilon(0.03));
}

TEST_CASE("cut-outs: the camera sees through them") {
    auto scene = std::make_shared<Scene>();
    add_plate(*scene, 0.0f, 5.0f, true, scene->add_material(black(0.25f)));
    scene->set_environment(constant_environment(2.0f));
    scene->set_camera(look({0, 3, 0}, {0, 0, 0}, 0.3f, {0, 0, 1}));
    const Estimate seen_through = render_mean(committed(scene), square_image(16, 1));
    CHECK(agree(seen_through, 1.0, {1.5, 0.0}));
    CHECK(seen_through.variance < 0.02 * 0.02);
}

TEST_CASE("cut-outs: opacities are checked, and their textures need texture coordinates") {
    Scene scene;
    Material m = black(1.5f);
    CHECK_THROWS_WITH_AS(scene.add_material(m), "material 0: opacity is 1.500000, not in [0, 1]",
                         Error);
    m = black(1.0f);
    m.opacity_threshold = -1.0f;
    CHECK_THROWS_WITH_AS(scene.add_material(m),
                         "material 0: opacity_threshold is -1.000000, not in [0, 1]", Error);
    m = black(1.0f);
    m.opacity_texture = 0;
    CHECK_THROWS_WITH_AS(scene.add_material(m),
                         "material 0: opacity_texture is 0, but there are 0 textures", Error);
    scene.add_texture({1, 1, {{1, 1, 1}}});
    scene.add_material(m);
    Shape shape;
    shape.add_level_square({0, 0, 0}, 1.0f, true);
    CHECK_THROWS_WITH_AS(scene.add_mesh(shape.mesh("plate", 0)),
                         "mesh \"plate\": material 0 has textures, and the mesh has no uvs", Error);
}
