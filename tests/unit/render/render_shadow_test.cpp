#include "base/random.h"
#include "render/emitter.h"
#include "render/ray_tracer.h"
#include "render/scene_data.h"
#include "render/shadow_filter.h"
#include "unit/render/render_support.h"

#include <doctest/doctest.h>

#include <ImathVec.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

/// These tests show that shadow rays end at the light: what lies right before it hides it, and
/// neither the light itself nor its neighbours do.

using namespace render_support;
using Imath::V3d;
using lightcull::Basis;
using lightcull::RandomStream;
using lightcull::Ray;
using lightcull::segment;
using lightcull::V2f;
using lightcull::V3f;

namespace {

/// A frame that is turned and moved; places in it are rounded to floats last.
struct Frame {
    Basis basis;
    V3d origin;

    float3 operator()(double x, double y, double z) const {
        const V3d p =
            origin + V3d(basis.tangent) * x + V3d(basis.bitangent) * y + V3d(basis.normal) * z;
        return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    }
};

V3f random_direction(RandomStream& random) {
    const float z = 2.0f * random.next() - 1.0f, phi = 2.0f * lightcull::kPi * random.next();
    const float r = std::sqrt(1.0f - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// Along an axis, and turned.
std::vector<Frame> frames(double far) {
    RandomStream random(11);
    std::vector<Frame> all{{Basis({0, 0, 1}), V3d(0.0)}, {Basis({0, 0, -1}), V3d(0, 0, far)}};
    for (int i = 0; i < 6; ++i) {
        const V3d away(random_direction(random));
        all.push_back({Basis(random_direction(random)), away * far * (i % 2)});
    }
    return all;
}

/// A panel of cells * cells squares in the plane z = height, seen from below.
Shape panel(const Frame& frame, double half_edge, double height, int cells) {
    Shape s;
    const auto at = [&](int i) { return half_edge * (2.0 * i / cells - 1.0); };
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) s.positions.push_back(frame(at(i), at(j), height));
    }
    for (int j = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (cells + 1) + i);
            const auto b = a + static_cast<std::uint32_t>(cells) + 1;
            s.indices.insert(s.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
        }
    }
    return s;
}

/// Places at a distance from the frame's origin, below the plane z = 0, down to grazing ones.
std::vector<V3f> places_below(const Frame& frame, double distance, double least_cosine, int count) {
    RandomStream random(4);
    std::vector<V3f> all;
    for (int i = 0; i < count; ++i) {
        const double cosine =
            least_cosine + (1.0 - least_cosine) * std::pow(static_cast<double>(random.next()), 3.0);
        const double sine = std::sqrt(1.0 - cosine * cosine);
        const double phi = 2.0 * render_support::kPi * static_cast<double>(random.next());
        all.push_back(lightcull::to_v3f(frame(
            distance * sine * std::cos(phi), distance * sine * std::sin(phi), -distance * cosine)));
    }
    return all;
}

/// The light that the places get, in any unit: what would arrive, and what is hidden of it.
struct Arriving {
    double all = 0.0, hidden = 0.0;
    int rays = 0;

    double hidden_part() const { return hidden / all; }
};

Arriving light_at(const std::vector<V3f>& places, const Scene& scene) {
    const auto& impl = data_of(scene);
    RandomStream random(1);
    std::vector<Ray> rays;
    std::vector<double> values;
    for (const V3f& from : places) {
        const auto i = random.next() * static_cast<float>(impl.emitters.size());
        const float x = random.next();
        const auto s = sample_emitter(impl, impl.emitters[static_cast<std::size_t>(i)], from,
                                      {0.5, V2f(x, random.next())});
        if (!(s.pdf > 0.0f && s.radiance.x > 0.0f)) continue;
        rays.push_back(segment(from, s.place, s.triangle));
        values.push_back(static_cast<double>(s.radiance.x / s.pdf));
    }
    std::vector<std::uint8_t> occluded(rays.size());
    impl.ray_tracer->occluded(rays, occluded);
    Arriving light;
    light.rays = static_cast<int>(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        light.all += values[i];
        if (occluded[i] != 0) light.hidden += values[i];
    }
    return light;
}

enum class Lamp { kPanel, kPoint, kSpot };

/// A lamp that shines down from z = 0, and a plate above it, below it or in its plane.
std::unique_ptr<Scene> lamp_and_plate(const Frame& frame, Lamp lamp, double distance,
                                      double plate_height) {
    auto scene = std::make_unique<Scene>();
    scene->add_material({});
    if (lamp == Lamp::kPanel) {
        scene->add_mesh(panel(frame, 0.01 * distance, 0.0, 1).mesh("lamp", 0, emission(1.0f)));
    } else if (lamp == Lamp::kPoint) {
        scene->add_point_light(frame(0, 0, 0), {1, 1, 1});
    } else {
        scene->add_spot_light(frame(0, 0, 0), lightcull::to_float3(-frame.basis.normal), {1, 1, 1},
                              3.0f, 3.0f);
    }
    scene->add_mesh(panel(frame, 0.05 * distance, plate_height, 3).mesh("plate", 0));
    scene->commit();
    return scene;
}

constexpr double kUnit = 0x1p-24;
constexpr double kDistances[] = {1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5};
constexpr Lamp kLamps[] = {Lamp::kPanel, Lamp::kPoint, Lamp::kSpot};

}  // namespace

TEST_CASE("a triangle hides an end that lies behind its plane, and no other") {
    Scene scene;
    scene.add_material(diffuse(0.5f));
    Shape triangle;
    triangle.positions = {{-1, -1, 2}, {1, -1, 2}, {0, 1, 2}};
    triangle.indices = {0, 1, 2};
    scene.add_mesh(triangle.mesh("triangle", 0));
    const Hit hit{0, 0.25f, 0.25f};
    const auto hides = [&](float start, float end) {
        // However Embree may have rounded the distance of the hit.
        return hides_end(data_of(scene), hit, 0.5f, segment({0, 0, start}, {0, 0, end}));
    };
    CHECK(hides(1.0f, 3.0f));
    CHECK(hides(1.0f, 2.000001f));
    CHECK_FALSE(hides(1.0f, 2.0f));
    CHECK_FALSE(hides(1.0f, 1.999f));
    CHECK(hides(3.0f, 1.999999f));
    CHECK_FALSE(hides(3.0f, 2.001f));
    CHECK(hides_end(data_of(scene), hit, 0.5f, Ray{{0, 0, 1}, {0, 0, 1}}));
}

TEST_CASE("a plate right before a light hides all of it, and one right behind it nothing") {
    for (const double distance : kDistances) {
        for (const double far : {0.0, 10.0 * distance}) {
            for (const Frame& frame : frames(far)) {
                const bool is_level = std::fabs(frame.basis.normal.z) == 1.0f;
                const double from_origin = std::max(frame.origin.length(), distance);
                // Beside the rounding of the end, that of turned lamps and plates.
                const double gap = (is_level ? 8.0 : 16.0) * kUnit * from_origin;
                const auto places = places_below(frame, distance, 0.05, 300);
                for (const Lamp lamp : kLamps) {
                    CAPTURE(distance);
                    CAPTURE(far);
                    CAPTURE(static_cast<int>(lamp));
                    CAPTURE(is_level);
                    const Arriving before =
                        light_at(places, *lamp_and_plate(frame, lamp, distance, -gap));
                    CHECK(before.rays == 300);
                    CHECK(before.hidden == before.all);
                    CHECK(light_at(places, *lamp_and_plate(frame, lamp, distance, gap)).hidden ==
                          0.0);
                    const Arriving within =
                        light_at(places, *lamp_and_plate(frame, lamp, distance, 0.0));
                    CHECK(within.hidden_part() <= (is_level ? 0.0 : 1e-3));
                }
            }
        }
    }
}

TEST_CASE("a lamp hides neither itself nor its neighbours in its plane") {
    // Of 16 x 16 squares; turned, they are in one plane but for rounding.
    for (const double distance : kDistances) {
        for (const double far : {0.0, 10.0}) {
            for (const double size : {1e-2, 1.0, 100.0}) {
                for (const int cells : {1, 16}) {
                    for (const Frame& frame : frames(far * distance)) {
                        Scene scene;
                        scene.add_material({});
                        scene.add_mesh(panel(frame, size * distance, 0.0, cells)
                                           .mesh("lamp", 0, emission(1.0f)));
                        scene.commit();
                        CAPTURE(distance);
                        CAPTURE(far);
                        CAPTURE(size);
                        CAPTURE(cells);
                        const Arriving light =
                            light_at(places_below(frame, distance, 0.0, 1000), scene);
                        CHECK(light.rays > 950);
                        CHECK(light.hidden_part() <= (cells == 1 ? 0.0 : 1e-5));
                    }
                }
            }
        }
    }
}

TEST_CASE("a round lamp of small triangles hides nothing of what faces a point") {
    // The triangles of the smallest are about as large as the rounding of the way to them.
    const std::pair<double, double> sizes[] = {
        {1.0, 1e-7}, {1e-2, 1e-7}, {1e-4, 1e-4}, {1e-6, 1e-3}};
    for (const double distance : kDistances) {
        for (const auto& of_size : sizes) {
            const double size = of_size.first, bound = of_size.second;
            Arriving all;
            for (const Frame& frame : frames(0.0)) {
                Shape lamp;
                lamp.add_sphere({0, 0, 0}, 1.0f, 20);
                const double radius = size * distance;
                for (float3& p : lamp.positions) {
                    p = frame(static_cast<double>(p.x) * radius, static_cast<double>(p.y) * radius,
                              static_cast<double>(p.z) * radius);
                }
                Scene scene;
                scene.add_material({});
                scene.add_mesh(lamp.mesh("lamp", 0, emission(1.0f)));
                scene.commit();
                const Arriving light =
                    light_at(places_below(frame, distance + radius, 0.0, 4000), scene);
                all.all += light.all;
                all.hidden += light.hidden;
            }
            CAPTURE(distance);
            CAPTURE(size);
            CHECK(all.hidden_part() <= bound);
        }
    }
}
