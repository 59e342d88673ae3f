#include "courtyard.h"

#include "base/float3_math.h"
#include "base/random.h"

#include <array>
#include <cmath>
#include <vector>

namespace lightcull::bench {
namespace {

constexpr float kHalf = 20.0f, kHeight = 8.0f;  // metres
constexpr std::uint32_t kTriangles = 20;        // triangles of a lantern
constexpr float kTotalPower = 10000.0f;         // radiance times area, summed over all lights

struct Shape {
    std::vector<float3> positions;
    std::vector<std::uint32_t> indices;

    /// Adds a quad whose corners run anticlockwise, seen from the front.
    void add_quad(float3 a, float3 b, float3 c, float3 d) {
        const auto first = static_cast<std::uint32_t>(positions.size());
        positions.insert(positions.end(), {a, b, c, d});
        for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) indices.push_back(first + i);
    }

    /// Adds the four sides of an upright box.
    void add_sides(float3 middle, float half_edge, float height) {
        const std::array<float, 5> x{-1, 1, 1, -1, -1}, z{1, 1, -1, -1, 1};
        for (std::size_t i = 0; i < 4; ++i) {
            const float3 a = middle + float3{x[i], 0, z[i]} * half_edge;
            const float3 b = middle + float3{x[i + 1], 0, z[i + 1]} * half_edge;
            const float3 up{0, height, 0};
            add_quad(a, b, b + up, a + up);
        }
    }

    void add_icosahedron(float3 center, float radius) {
        constexpr float kA = 0.52573111f, kB = 0.85065081f;
        constexpr std::array<float3, 12> kCorners{{{-kA, kB, 0},
                                                   {kA, kB, 0},
                                                   {-kA, -kB, 0},
                                                   {kA, -kB, 0},
                                                   {0, -kA, kB},
                                                   {0, kA, kB},
                                                   {0, -kA, -kB},
                                                   {0, kA, -kB},
                                                   {kB, 0, -kA},
                                                   {kB, 0, kA},
                                                   {-kB, 0, -kA},
                                                   {-kB, 0, kA}}};
        constexpr std::array<std::uint32_t, std::size_t{3} * kTriangles> kFaces{
            0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
            4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
            6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
        const auto first = static_cast<std::uint32_t>(positions.size());
        for (const float3& corner : kCorners) positions.push_back(center + corner * radius);
        for (const std::uint32_t i : kFaces) indices.push_back(first + i);
    }

    Mesh mesh(const char* name) const {
        Mesh mesh;
        mesh.name = name;
        mesh.positions = positions;
        mesh.indices = indices;
        return mesh;
    }
};

float3 place_in_court(RandomStream& random, float margin) {
    const auto across = [&] { return (2.0f * random.next() - 1.0f) * (kHalf - margin); };
    const float x = across(), z = across();
    return {x, 0.0f, z};
}

void add_walls(Scene& scene, RandomStream& random) {
    constexpr int kPillars = 60;
    constexpr float h = kHalf;
    Shape shape;
    shape.add_quad({-h, 0, h}, {h, 0, h}, {h, 0, -h}, {-h, 0, -h});
    shape.add_sides({0, 0, 0}, h, kHeight);
    for (int i = 0; i < kPillars; ++i) {
        shape.add_sides(place_in_court(random, 2.0f), 0.2f, 0.7f * kHeight);
    }
    Mesh mesh = shape.mesh("walls");
    mesh.material = scene.add_material({});
    scene.add_mesh(mesh);
}

/// A random number of mean 0 and deviation 1, near enough to normal.
float bell(RandomStream& random) {
    float sum = -6.0f;
    for (int i = 0; i < 12; ++i) sum += random.next();
    return sum;
}

void add_lanterns(Scene& scene, RandomStream& random, std::uint32_t count) {
    constexpr float kSpread = 1.5f;  // deviation of the logarithm of a lantern's power
    const float radius = std::fmin(0.1f, 0.1f * std::cbrt(1000.0f / static_cast<float>(count)));
    Shape shape;
    std::vector<float> powers;
    float sum = 0.0f;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float3 foot = place_in_court(random, 0.5f);
        shape.add_icosahedron(foot + float3{0, 0.3f + 0.8f * kHeight * random.next(), 0}, radius);
        powers.push_back(std::exp(kSpread * bell(random)));
        sum += powers.back();
    }
    const float area = 9.57f * radius * radius;  // area of an icosahedron in a sphere of that
                                                 // radius
    std::vector<float3> radiance;
    for (const float power : powers) {
        const float value = power / sum * kTotalPower / area;
        radiance.insert(radiance.end(), kTriangles, float3{value, value, value});
    }
    Mesh mesh = shape.mesh("lanterns");
    mesh.material = scene.add_material({});
    mesh.emission.radiance = {1, 1, 1};
    mesh.emission.face_radiance = radiance;
    scene.add_mesh(mesh);
}

}  // namespace

std::shared_ptr<const Scene> make_courtyard(std::uint32_t light_count) {
    auto scene = std::make_shared<Scene>();
    RandomStream random(light_count);
    add_walls(*scene, random);
    add_lanterns(*scene, random, light_count / kTriangles);
    Camera camera;
    camera.origin = {-0.9f * kHalf, 2.0f, 0.9f * kHalf};
    camera.target = {0.0f, 1.5f, 0.0f};
    scene->set_camera(camera);
    scene->commit();
    return scene;
}

}  // namespace lightcull::bench
