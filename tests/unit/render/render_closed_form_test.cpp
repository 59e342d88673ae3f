#include "unit/render/render_support.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace render_support;
using statistics::Estimate;

namespace {

struct Vector {
    double x, y, z;
};
Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Lambert's formula: irradiance at the origin of the plane y = 0 by a polygon above it that emits
/// a radiance of 1.
double polygon_irradiance(const std::vector<Vector>& corners) {
    double sum = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector &a = corners[i], &b = corners[(i + 1) % corners.size()];
        const Vector normal = cross(a, b);
        const double length = std::sqrt(dot(normal, normal));
        const double angle = std::atan2(length, dot(a, b));
        sum += 0.5 * angle * normal.y / length;
    }
    return std::fabs(sum);
}

/// A floor at y = 0 that a camera sees from the side, from so near to one direction and so far that
/// all it sees is the origin.
std::shared_ptr<Scene> floor_scene(const Material& material, float view_angle) {
    auto scene = std::make_shared<Scene>();
    scene->add_material(material);
    Shape floor;
    floor.add_level_square({0, 0, 0}, 50.0f, true);
    scene->add_mesh(floor.mesh("floor", 0));
    scene->set_camera(look({0, 10.0f * std::cos(view_angle), 10.0f * std::sin(view_angle)},
                           {0, 0, 0}, 1e-3f, {0, 0.3f, -1}));
    return scene;
}

void check_equals(const Estimate& estimate, double exact) {
    CAPTURE(estimate.mean);
    CAPTURE(std::sqrt(estimate.variance));
    CAPTURE(exact);
    // Where all samples are alike, rounding is what is left.
    if (std::fabs(estimate.mean - exact) < 2e-5 * exact) return;
    CHECK(statistics::p_of_z(statistics::z_of(estimate, {exact, 0.0})) > statistics::least_p());
    // The error is so small that the comparison is worth something.
    CHECK(std::sqrt(estimate.variance) < 0.01 * exact);
}

/// GGX's albedo for light from `cosine` with a Fresnel term of 1, by quadrature over the half
/// vector in double; written apart from the renderer's.
double single_scattering_albedo(double cosine, double alpha) {
    const double a2 = alpha * alpha;
    const auto masking = [&](double c) {
        return 2.0 * c / (c + std::sqrt(a2 + (1.0 - a2) * c * c));
    };
    const Vector view{std::sqrt(1.0 - cosine * cosine), 0.0, cosine};
    constexpr int kSteps = 1000;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        // D cos is uniform in q^4 and in the angle about the normal; most of what is lost is lost
        // in the tail, at small q.
        const double q = (i + 0.5) / kSteps, rest = q * q * q * q;
        const double z = std::sqrt(rest / (a2 + (1.0 - a2) * rest));
        const double weight = 4.0 * q * q * q;
        for (int j = 0; j < kSteps; ++j) {
            const double angle = 2.0 * kPi * (j + 0.5) / kSteps;
            const double sine = std::sqrt(1.0 - z * z);
            const Vector half{sine * std::cos(angle), sine * std::sin(angle), z};
            const double view_half = dot(view, half);
            const double light_cosine = 2.0 * view_half * half.z - view.z;
            if (view_half <= 0.0 || light_cosine <= 0.0) continue;
            sum += weight * masking(light_cosine) * masking(cosine) * view_half / (cosine * half.z);
        }
    }
    return sum / (kSteps * kSteps);
}

}  // namespace

TEST_CASE("irradiance by a polygon light is Lambert's") {
    // A planar pentagon, made of three triangles.
    const std::vector<Vector> corners{
        {-1, 1.9, 0.5}, {0.5, 2.3, 1}, {1.2, 2.14, -0.5}, {0.3, 1.72, -1.7}, {-1, 1.55, -1.25}};
    for (const auto technique : {DirectLight::kLights, DirectLight::kMis}) {
        auto scene = floor_scene(diffuse(0.6f), 1.2f);
        Shape light;
        for (const Vector& c : corners) {
            light.positions.push_back(
                {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)});
        }
        light.indices = {0, 1, 2, 0, 2, 3, 0, 3, 4};
        Emission e = emission(3.0f);
        e.two_sided = true;
        scene->add_mesh(light.mesh("light", 0, e));
        RenderSettings settings = square_image(32, 2);
        settings.direct_light = technique;
        check_equals(render_mean(committed(scene), settings),
                     0.6 / kPi * 3.0 * polygon_irradiance(corners));
    }
}

TEST_CASE("a point light falls off with the square of the distance and the cosine") {
    for (const float distance : {0.1f, 1.0f, 30.0f}) {
        for (const float angle : {0.0f, 1.0f}) {
            auto scene = floor_scene(diffuse(0.5f), 0.9f);
            scene->add_point_light({distance * std::sin(angle), distance * std::cos(angle), 0},
                                   {7, 7, 7});
            const Estimate e = render_mean(committed(scene), square_image(8, 2), "uniform", 4);
            const double exact = 0.5 / kPi * 7.0 * std::cos(angle) / (distance * distance);
            CHECK(e.mean == doctest::Approx(exact).scale(0.0).epsilon(0.02));
        }
    }
}

TEST_CASE("a spot is full up to its inner angle, a squared ramp in the cosine after, then dark") {
    const auto lit = [](float angle_to_axis) {
        auto scene = floor_scene(diffuse(0.5f), 0.9f);
        scene->add_spot_light({0, 2, 0}, {std::sin(angle_to_axis), -std::cos(angle_to_axis), 0},
                              {4, 4, 4}, 0.3f, 0.6f);
        return render_mean(committed(scene), square_image(8, 2), "uniform", 4).mean /
               (0.5 / kPi * 4.0 / 4.0);
    };
    const double ramp = (std::cos(0.45) - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6));
    CHECK(lit(0.0f) == doctest::Approx(1.0).scale(0.0).epsilon(0.01));
    CHECK(lit(0.28f) == doctest::Approx(1.0).scale(0.0).epsilon(0.01));
    CHECK(lit(0.45f) == doctest::Approx(ramp * ramp).scale(0.0).epsilon(0.02));
    CHECK(lit(0.62f) == 0.0);
}

TEST_CASE("emitters and the environment are seen directly at max_depth 1") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.5f));
    Shape light;
    light.add_level_square({0, 0, 0}, 50.0f, true);
    scene->add_mesh(light.mesh("light", 0, emission(2.0f)));
    scene->set_environment(constant_environment(3.0f));
    scene->set_camera(look({0, 1, 0}, {0, 1, -1}, 1.0f));
    scene->commit();
    for (const auto technique : {DirectLight::kLights, DirectLight::kBsdf, DirectLight::kMis}) {
        RenderSettings settings = square_image(4, 1);
        settings.direct_light = technique;
        Renderer renderer(scene, settings, make_sampler(UniformOptions{}, scene->lights()));
        CHECK(luminance(renderer.image()[0]) == 0.0);
        renderer.render_pass();
        CHECK(luminance(renderer.image()[0]) == doctest::Approx(3.0));
        CHECK(luminance(renderer.image()[15]) == doctest::Approx(2.0));
    }
}

TEST_CASE("in a furnace a white surface cannot be seen") {
    for (const auto technique : {DirectLight::kLights, DirectLight::kBsdf, DirectLight::kMis}) {
        auto scene = std::make_shared<Scene>();
        scene->add_material(diffuse(1.0f));
        Shape shape;
        shape.add_sphere({0, 0, 0}, 1.0f, 12);
        // The shape has a concave corner, too: it takes several bounces.
        shape.add_level_square({0, -1.0f, 0}, 2.0f, true);
        scene->add_mesh(shape.mesh("white", 0));
        scene->set_environment(constant_environment(1.0f));
        scene->set_camera(look({0, 1, 4}, {0, 0, 0}, 0.6f));
        RenderSettings settings = square_image(32, 1000);
        settings.direct_light = technique;
        settings.rr_depth = settings.max_depth;
        scene->commit();
        const auto blocks =
            render_blocks(scene, settings, make_sampler(UniformOptions{}, scene->lights()), 500, 8);
        for (const Estimate& block : blocks) {
            check_equals(block, 1.0);
        }
    }
}

TEST_CASE("Russian roulette changes nothing in the mean") {
    auto scene = std::make_shared<Scene>();
    scene->add_material(diffuse(0.8f));
    Shape room;
    room.add_level_square({0, 0, 0}, 2.0f, true);
    room.add_level_square({0, 2, 0}, 2.0f, false);
    scene->add_mesh(room.mesh("room", 0));
    scene->set_environment(constant_environment(1.0f));
    scene->set_camera(look({0, 1, 3}, {0, 1, 0}, 0.9f));
    scene->commit();
    RenderSettings settings = square_image(32, 20);
    settings.rr_depth = 100;
    const Estimate without = render_mean(scene, settings, "uniform", 100);
    settings.rr_depth = 1;
    settings.seed = 1;
    const Estimate with = render_mean(scene, settings, "uniform", 100);
    CHECK(statistics::p_of_z(statistics::z_of(with, without)) > statistics::least_p());
    CHECK(std::sqrt(with.variance) < 0.01 * with.mean);
    CHECK(with.mean != without.mean);
}

TEST_CASE("a white metal reflects its single-scattering albedo") {
    for (const float roughness : {0.05f, 0.2f, 0.5f, 0.8f, 1.0f}) {
        for (const float angle : {0.0f, 0.8f, 1.4f}) {
            for (const auto technique : {DirectLight::kBsdf, DirectLight::kMis}) {
                CAPTURE(roughness);
                CAPTURE(angle);
                auto scene = floor_scene(metal(roughness), angle);
                scene->set_environment(constant_environment(2.0f));
                RenderSettings settings = square_image(32, 2);
                settings.direct_light = technique;
                const double alpha =
                    static_cast<double>(roughness) * static_cast<double>(roughness);
                check_equals(
                    render_mean(committed(scene), settings, "uniform", 200),
                    2.0 * single_scattering_albedo(std::cos(static_cast<double>(angle)), alpha));
            }
        }
    }
}
