#include "render/bsdf.h"
#include "unit/render/render_support.h"
#include "virtual_lights/paths/light_paths.h"

#include <lightcull/error.h>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <vector>

using namespace render_support;
using lightcull::Bsdf;
using lightcull::VirtualLight;

namespace {

constexpr double kPiDouble = render_support::kPi;

/// A closed box about the origin, of half edge 1, whose inside has an albedo.
std::shared_ptr<Scene> box(float albedo) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(albedo));
    Shape walls;
    walls.add_level_square({0, -1, 0}, 1.0f, true);
    walls.add_level_square({0, 1, 0}, 1.0f, false);
    walls.add_quad({-1, -1, 1}, {-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1});
    walls.add_quad({1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1});
    walls.add_quad({-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1});
    walls.add_quad({1, -1, 1}, {-1, -1, 1}, {-1, 1, 1}, {1, 1, 1});
    scene->add_mesh(walls.mesh("walls", 0));
    return scene;
}

std::shared_ptr<Scene> box_with_point() {
    auto scene = box(0.5f);
    scene->add_point_light({0, 0, 0}, {1, 1, 1});
    return scene;
}

std::vector<VirtualLight> lights_of(Scene& scene, std::uint32_t count, std::uint32_t bounces,
                                    std::uint64_t key = 1) {
    scene.commit();
    const EmissionTable emission(data_of(scene));
    return virtual_lights(data_of(scene), emit(emission, count, key), bounces, key);
}

/// The flux that diffuse lights have received on surfaces of an albedo, W by luminance.
double flux(const std::vector<VirtualLight>& lights, double albedo) {
    double sum = 0.0;
    for (const VirtualLight& light : lights) {
        sum += static_cast<double>(lightcull::luminance(light.strength)) * kPiDouble / albedo;
    }
    return sum;
}

constexpr std::uint32_t kPaths = 20000;

}  // namespace

TEST_CASE("virtual lights: in a closed box all flux of the emitters arrives") {
    auto scene = box(0.5f);
    Shape lamp;
    lamp.add_level_square({0, 0.5f, 0}, 0.25f, false);
    SUBCASE("one-sided triangles") {
        scene->add_mesh(lamp.mesh("lamp", 0, emission(3.0f)));
        CHECK(flux(lights_of(*scene, kPaths, 1), 0.5) == doctest::Approx(kPiDouble * 3.0 * 0.25));
    }
    SUBCASE("two-sided triangles") {
        Emission e = emission(3.0f);
        e.two_sided = true;
        scene->add_mesh(lamp.mesh("lamp", 0, e));
        CHECK(flux(lights_of(*scene, kPaths, 1), 0.5) ==
              doctest::Approx(2.0 * kPiDouble * 3.0 * 0.25));
    }
    SUBCASE("points, in proportion to their power") {
        scene->add_point_light({0, 0, 0}, {2, 2, 2});
        scene->add_point_light({0.3f, 0, 0}, {0, 0, 0});
        scene->add_point_light({0, 0.3f, 0}, {5, 5, 5});
        CHECK(flux(lights_of(*scene, kPaths, 1), 0.5) == doctest::Approx(4.0 * kPiDouble * 7.0));
    }
    SUBCASE("a spot, whose rays differ by its ramp") {
        scene->add_spot_light({0, 0, 0}, {1, 2, 3}, {4, 4, 4}, 0.3f, 0.7f);
        const double ramp = (std::cos(0.3) - std::cos(0.7)) / 3.0;
        CHECK(flux(lights_of(*scene, kPaths, 1), 0.5) ==
              doctest::Approx(2.0 * kPiDouble * 4.0 * (1.0 - std::cos(0.3) + ramp))
                  .scale(0.0)
                  .epsilon(0.02));
    }
}

TEST_CASE("virtual lights: each bounce keeps the albedo of the flux, in lights about as strong") {
    auto scene = box(0.5f);
    scene->add_point_light({0, 0, 0}, {1, 1, 1});
    scene->commit();
    const EmissionTable emission(data_of(*scene));
    statistics::Accumulator three;
    for (std::uint64_t key = 0; key < 40; ++key) {
        const auto lights = virtual_lights(data_of(*scene), emit(emission, 1000, key), 3, key);
        three.add(flux(lights, 0.5));
        for (const VirtualLight& light : lights) {
            CHECK(light.strength.x == doctest::Approx(lights[0].strength.x));
        }
    }
    const statistics::Estimate exact{4.0 * kPiDouble * (1.0 + 0.5 + 0.25), 0.0};
    const statistics::Estimate found = three.estimate();
    CHECK(std::sqrt(found.variance) < 0.005 * found.mean);
    CHECK(statistics::p_of_z(statistics::z_of(found, exact)) > statistics::least_p());
}

TEST_CASE(
    "virtual lights: each emitter sends rays in proportion to its power, and where it shines") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape one_sided, two_sided;
    one_sided.add_level_square({0, 2, 0}, 0.5f, false);
    two_sided.add_level_square({0, 4, 0}, 0.5f, true);
    Emission both = emission(2.0f);
    both.two_sided = true;
    scene->add_mesh(one_sided.mesh("one-sided", 0, emission(3.0f)));
    scene->add_mesh(two_sided.mesh("two-sided", 0, both));
    const V3f point(5, 5, 5), spot(-5, -5, -5), axis(0, 0.6f, 0.8f);
    scene->add_point_light({5, 5, 5}, {1, 1, 1});
    scene->add_spot_light({-5, -5, -5}, {0, 0.6f, 0.8f}, {9, 9, 9}, 0.3f, 0.7f);
    scene->set_environment(constant_environment(0.02f));
    scene->commit();

    enum Kind { kOneSided, kTwoSided, kPoint, kSpot, kEnvironment, kKinds };
    const auto kind_of = [&](const V3f& origin) {
        if (origin == point) return kPoint;
        if (origin == spot) return kSpot;
        const bool is_above_lamps = std::fabs(origin.x) <= 0.5f && std::fabs(origin.z) <= 0.5f;
        if (is_above_lamps && std::fabs(origin.y - 2.0f) < 0.01f) return kOneSided;
        if (is_above_lamps && std::fabs(origin.y - 4.0f) < 0.01f) return kTwoSided;
        return kEnvironment;
    };
    constexpr std::uint32_t kCount = 200000;
    const EmissionTable table(data_of(*scene));
    double number[kKinds] = {}, flux[kKinds] = {}, height[kKinds] = {}, above[kKinds] = {};
    V3f sum(0.0f);
    for (const lightcull::LightRay& ray : emit(table, kCount, 1)) {
        const Kind kind = kind_of(ray.ray.origin);
        const V3f& way = ray.ray.direction;
        CHECK(way.length() == doctest::Approx(1.0));
        number[kind] += 1.0;
        flux[kind] += static_cast<double>(ray.flux.x);
        height[kind] += static_cast<double>(kind == kSpot ? way.dot(axis) : std::fabs(way.y));
        above[kind] += way.y > 0.0f ? 1.0 : 0.0;
        if (kind == kPoint) sum += way;
    }
    // The means are of some thousands of rays each: 5 standard errors and more, as for all that
    // follows.
    for (int kind = 0; kind < kKinds; ++kind) {
        CAPTURE(kind);
        REQUIRE(number[kind] > 4000.0);
        CHECK(flux[kind] / number[kind] / (flux[kPoint] / number[kPoint]) ==
              doctest::Approx(1.0).scale(0.0).epsilon(0.015));
        height[kind] /= number[kind];
        above[kind] /= number[kind];
    }
    CHECK(flux[kPoint] == doctest::Approx(4.0 * kPiDouble).scale(0.0).epsilon(0.05));
    CHECK(std::fabs(height[kPoint] - 0.5) < 0.03);
    CHECK(static_cast<double>(sum.length()) < 0.06 * number[kPoint]);
    CHECK(std::fabs(height[kSpot] - 0.5 * (1.0 + std::cos(0.7))) < 0.01);
    CHECK(std::fabs(height[kOneSided] - 2.0 / 3.0) < 0.03);
    CHECK(above[kOneSided] == 0.0);
    CHECK(std::fabs(height[kTwoSided] - 2.0 / 3.0) < 0.03);
    CHECK(std::fabs(above[kTwoSided] - 0.5) < 0.04);
}

TEST_CASE("virtual lights: a textured lamp sends light from where it is bright") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Texture half{4, 1, {{0, 0, 0}, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}}};
    Emission textured = emission(1.0f);
    textured.texture = scene->add_texture(half);
    Shape lamp;
    lamp.add_quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
    const float2 uvs[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    Mesh mesh = lamp.mesh("lamp", 0, textured);
    mesh.uvs = uvs;
    scene->add_mesh(mesh);
    scene->commit();
    int bright = 0;
    double flux = 0.0;
    for (const lightcull::LightRay& ray : emit(EmissionTable(data_of(*scene)), 2000, 1)) {
        const float x = ray.ray.origin.x;
        // The places are away from where texels are blended.
        CHECK_FALSE((x > 0.15f && x < 0.35f));
        if (x > 0.65f && x < 0.85f) ++bright;
        flux += static_cast<double>(ray.flux.x);
    }
    CHECK(bright > 500);
    // pi times the area times the mean, each ray having the flux of all over their number.
    CHECK(flux == doctest::Approx(0.5 * render_support::kPi).epsilon(0.01));
}

TEST_CASE("virtual lights: paths that begin alike part, and lights lie along a curve") {
    auto scene = box(0.9f);
    scene->add_point_light({0, 0, 0}, {1, 1, 1});
    scene->commit();
    // The paths are as many as several tasks have.
    const lightcull::LightRay down{{V3f(0.0f), V3f(0.0f, -1.0f, 0.0f)}, V3f(1.0f)};
    const std::vector<lightcull::LightRay> starts(10000, down);
    std::set<std::array<float, 3>> places;
    std::size_t second = 0;
    for (const VirtualLight& light : virtual_lights(data_of(*scene), starts, 2, 1)) {
        const V3f& p = light.position;
        if ((p - V3f(0.0f, -1.0f, 0.0f)).length() < 1e-5f) continue;  // the first, up to rounding
        ++second;
        places.insert({p.x, p.y, p.z});
    }
    CHECK(second > 8000);
    CHECK(places.size() + 10 > second);

    const std::vector<VirtualLight> lights = lights_of(*box_with_point(), kPaths, 1);
    double steps = 0.0;
    for (std::size_t i = 1; i < lights.size(); ++i) {
        steps += static_cast<double>((lights[i].position - lights[i - 1].position).length());
    }
    CHECK(steps / static_cast<double>(lights.size()) < 0.1);
}

TEST_CASE("virtual lights: a constant environment gives a sphere pi times its area") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape ball;
    ball.add_sphere({5, 0, 0}, 1.0f, 64);
    scene->add_mesh(ball.mesh("ball", 0));
    scene->set_environment(constant_environment(2.0f));
    const double sphere = 4.0 * kPiDouble;
    CHECK(flux(lights_of(*scene, 4 * kPaths, 1), 0.5) ==
          doctest::Approx(2.0 * kPiDouble * sphere).scale(0.0).epsilon(0.02));
}

TEST_CASE("virtual lights: a reflective shadow map holds the flux of its spot") {
    struct Cone {
        float inner, outer;
    };
    for (const auto& [inner, outer] :
         {Cone{0.3f, 0.7f}, Cone{0.5f, 0.5f}, Cone{1e-4f, 3.5e-4f}, Cone{3.5e-4f, 3.5e-4f}}) {
        auto scene = box(0.5f);
        scene->add_spot_light({0, 0, 0}, {0, -1, 0}, {4, 4, 4}, inner, outer);
        scene->commit();
        const auto rays = shadow_map_rays(data_of(*scene), EmissionTable(data_of(*scene)), 64, 1);
        const auto lights = virtual_lights(data_of(*scene), rays, 1, 1);
        CHECK(lights.size() >= 64 * 64 - 64);  // a hard edge may lose rays of the rim
        const auto versine = [](double angle) { return 2.0 * std::pow(std::sin(0.5 * angle), 2); };
        const double full = versine(double{inner}), to = versine(double{outer});
        CHECK(flux(lights, 0.5) ==
              doctest::Approx(2.0 * kPiDouble * 4.0 * (full + (to - full) / 3.0))
                  .scale(0.0)
                  .epsilon(1e-3));
    }

    auto other = box(0.5f);
    other->add_point_light({0, 0, 0}, {1, 1, 1});
    other->commit();
    CHECK_THROWS_AS(check_shadow_map_sources(data_of(*other)), Error);
}

TEST_CASE(
    "virtual lights: a reflective shadow map of a sun in the sky, as of a directional light") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape floor;
    floor.add_level_square({3, 0, 0}, 1.0f, true);
    scene->add_mesh(floor.mesh("floor", 0));
    Texture sky{256, 128, std::vector<float3>(std::size_t{256} * 128)};
    sky.texels[std::size_t{40} * 256 + 30] = {900, 900, 900};
    scene->set_environment({sky, {1, 1, 1}, 0.0f});
    const double by_paths = flux(lights_of(*scene, 20 * kPaths, 1), 0.5);
    const auto rays = shadow_map_rays(data_of(*scene), EmissionTable(data_of(*scene)), 128, 1);
    CHECK(rays.size() == 128 * 128);
    // The square's share of the disk, foreshortened, for each ray that has light.
    double expected = 0.0;
    for (const lightcull::LightRay& ray : rays) {
        CHECK(ray.ray.direction.dot(rays[0].ray.direction) > 0.995f);
        const double height = -static_cast<double>(ray.ray.direction.y);
        if (ray.flux.x > 0.0f) expected += 4.0 * height / (2.0 * kPiDouble);
    }
    const auto lights = virtual_lights(data_of(*scene), rays, 1, 1);
    CHECK(flux(lights, 0.5) == doctest::Approx(by_paths).scale(0.0).epsilon(0.03));
    CHECK(static_cast<double>(lights.size()) == doctest::Approx(expected).scale(0.0).epsilon(0.05));
}

TEST_CASE("virtual lights: paths and a reflective shadow map hold what a directional light gives") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape floor;
    floor.add_level_square({3, 0, 0}, 1.0f, true);
    scene->add_mesh(floor.mesh("floor", 0));
    scene->add_directional_light({0.5f, -1.0f, 0.2f}, {4, 4, 4});
    const double exact = 4.0 * 4.0 / std::sqrt(1.29);  // irradiance, by area, by the cosine
    CHECK(flux(lights_of(*scene, 20 * kPaths, 1), 0.5) ==
          doctest::Approx(exact).scale(0.0).epsilon(0.02));
    check_shadow_map_sources(data_of(*scene));
    const auto rays = shadow_map_rays(data_of(*scene), EmissionTable(data_of(*scene)), 128, 1);
    CHECK(rays.size() == 128 * 128);
    CHECK(flux(virtual_lights(data_of(*scene), rays, 1, 1), 0.5) ==
          doctest::Approx(exact).scale(0.0).epsilon(0.01));
}

TEST_CASE("virtual lights: no light, or none that shines, gives none") {
    auto dark = box(0.5f);
    CHECK(lights_of(*dark, kPaths, 3).empty());
    auto faint = box(0.5f);
    faint->add_point_light({0, 0, 0}, {0, 0, 0});
    CHECK(lights_of(*faint, kPaths, 3).empty());
    auto black = box(0.0f);
    black->add_point_light({0, 0, 0}, {1, 1, 1});
    CHECK(lights_of(*black, kPaths, 3).empty());
}

TEST_CASE("virtual lights: the lobes of a surface send out what its BSDF does") {
    const V3f incoming = lightcull::unit(V3f(0.4f, -0.2f, 0.6f));
    const V3f flux(3.0f, 2.0f, 1.0f);
    for (const float roughness : {0.05f, 0.3f, 1.0f}) {
        for (const float metallic : {0.0f, 0.5f, 1.0f}) {
            Surface surface;
            surface.bsdf = Bsdf::metallic_roughness({0, 0, 1}, incoming, {0.8f, 0.5f, 0.2f},
                                                    metallic, roughness);
            std::vector<VirtualLight> lights;
            add_virtual_lights(surface, incoming, flux, lights);
            CHECK(lights.size() == (metallic == 1.0f ? 1 : 2));
            lightcull::RandomStream random(7);
            for (int i = 0; i < 1000; ++i) {
                // Half of the directions lie about the mirrored one.
                V3f out(random.next() - 0.5f, random.next() - 0.5f, random.next() - 0.2f);
                if (i % 2 == 0) out = V3f(-0.4f, 0.2f, 0.6f) + out * 0.1f;
                out = lightcull::unit(out);
                V3f sum(0.0f);
                for (const VirtualLight& light : lights) sum += intensity(light, out);
                const V3f expected = flux * surface.bsdf.evaluate(out).value;
                CHECK((sum - expected).length() <= 1e-3f * expected.length());
            }
        }
    }
}
