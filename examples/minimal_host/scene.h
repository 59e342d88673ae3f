#pragma once

// The host's own part: spheres on a floor under 1,500 small emissive triangles, camera rays, and
// the light that one emitter sends to one point. Nothing here knows of light sampling.

#include <lightcull/float3.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace host {

using lightcull::float3;

inline constexpr std::uint32_t kWidth = 128, kHeight = 96;
inline constexpr std::size_t kPixelCount = std::size_t{kWidth} * kHeight;
inline constexpr float kPi = 3.14159265f, kAlbedo = 0.7f, kOffset = 1e-3f;

inline float3 operator+(float3 a, float3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline float3 operator-(float3 a, float3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline float3 operator*(float s, float3 a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline float dot(float3 a, float3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline float3 cross(float3 a, float3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float3 normalize(float3 a) {
    return (1.0f / std::sqrt(dot(a, a))) * a;
}

using Random = std::mt19937;
inline float uniform(Random& random) {
    return static_cast<float>(random() >> 8) * 0x1p-24f;
}

struct Sphere {
    float3 center;
    float radius;
};
struct Emitter {  // a triangle that shines on the side from which a, b, c run anticlockwise
    float3 a, b, c;
    float radiance;
};
struct Scene {
    std::vector<Sphere> spheres;
    std::vector<Emitter> emitters;
};

inline Scene make_scene() {
    Scene scene;
    for (const float x : {-3.0f, -1.0f, 1.0f, 3.0f}) {
        for (const float z : {-3.0f, -1.0f, 1.0f, 3.0f})
            scene.spheres.push_back({{x, 0.6f, z}, 0.6f});
    }
    Random random(7);
    for (int i = 0; i < 1500; ++i) {
        const float3 a{10.0f * uniform(random) - 5.0f, 1.4f + 1.5f * uniform(random),
                       10.0f * uniform(random) - 5.0f};
        const float3 b = a + float3{0.05f, 0.04f * uniform(random), 0.0f};
        const float3 c = a + float3{0.0f, 0.04f * uniform(random), 0.05f};
        const float radiance = 4.0f * std::exp(3.0f * uniform(random));
        scene.emitters.push_back({a, b, c, radiance});
    }
    return scene;
}

/// The distance along the ray to the nearest surface, infinity if there is none; `normal` is set
/// there.
inline float intersect(const Scene& scene, float3 origin, float3 direction, float3& normal) {
    float nearest = INFINITY;
    if (direction.y < 0.0f) {
        nearest = -origin.y / direction.y;
        normal = {0, 1, 0};
    }
    for (const Sphere& sphere : scene.spheres) {
        const float3 to_center = sphere.center - origin;
        const float along = dot(to_center, direction);
        const float root =
            along * along - dot(to_center, to_center) + sphere.radius * sphere.radius;
        const float distance = root < 0.0f ? -1.0f : along - std::sqrt(root);
        if (distance > 0.0f && distance < nearest) {
            nearest = distance;
            normal = normalize(origin + distance * direction - sphere.center);
        }
    }
    return nearest;
}

struct Hit {
    std::uint32_t x, y;  // pixel
    float3 point, normal;
};

inline std::vector<Hit> trace_camera_rays(const Scene& scene) {
    const float3 eye{0, 3, 8};
    std::vector<Hit> hits;
    for (std::uint32_t y = 0; y < kHeight; ++y) {
        for (std::uint32_t x = 0; x < kWidth; ++x) {
            const float3 on_film{(static_cast<float>(x) + 0.5f - 0.5f * kWidth) / kHeight,
                                 (0.2f * kHeight - static_cast<float>(y)) / kHeight, -1};
            const float3 direction = normalize(on_film);
            float3 normal;
            const float distance = intersect(scene, eye, direction, normal);
            if (distance > 20.0f) continue;
            hits.push_back({x, y, eye + distance * direction + kOffset * normal, normal});
        }
    }
    return hits;
}

/// The radiance that leaves a diffuse point towards anywhere, by light from one vertex of an
/// emitter, divided by the density of that vertex on the emitter (its area's inverse).
inline float light_from(const Scene& scene, const Emitter& emitter, const Hit& hit,
                        Random& random) {
    const float root = std::sqrt(uniform(random)), v = root * uniform(random), u = 1.0f - root;
    const float3 vertex = emitter.a + u * (emitter.b - emitter.a) + v * (emitter.c - emitter.a);
    const float3 area_normal = 0.5f * cross(emitter.b - emitter.a, emitter.c - emitter.a);
    const float3 to_light = vertex - hit.point;
    const float distance = std::sqrt(dot(to_light, to_light));
    const float3 direction = (1.0f / distance) * to_light;
    const float cosine = dot(hit.normal, direction), area_cosine = -dot(area_normal, direction);
    float3 ignored;
    if (cosine <= 0.0f || area_cosine <= 0.0f ||
        intersect(scene, hit.point, direction, ignored) < distance) {
        return 0.0f;
    }
    return kAlbedo / kPi * emitter.radiance * cosine * area_cosine / (distance * distance);
}

}  // namespace host
