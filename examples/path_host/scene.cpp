#include "scene.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace host {
namespace {

float3 smaller(float3 a, float3 b) {
    return {std::fmin(a.x, b.x), std::fmin(a.y, b.y), std::fmin(a.z, b.z)};
}
float3 larger(float3 a, float3 b) {
    return {std::fmax(a.x, b.x), std::fmax(a.y, b.y), std::fmax(a.z, b.z)};
}

/// The distance to a triangle from its front or its back, infinity if there is none (Moeller &
/// Trumbore 1997).
float intersect(const Ray& ray, const Emitter& triangle) {
    const float3 ab = triangle.b - triangle.a, ac = triangle.c - triangle.a;
    const float3 p = cross(ray.direction, ac), to_origin = ray.origin - triangle.a;
    const float inverse = 1.0f / dot(ab, p), u = dot(to_origin, p) * inverse;
    const float3 q = cross(to_origin, ab);
    const float v = dot(ray.direction, q) * inverse, distance = dot(ac, q) * inverse;
    const bool inside = u >= 0.0f && v >= 0.0f && u + v <= 1.0f && distance > 0.0f;
    return inside ? distance : INFINITY;
}

float intersect(const Ray& ray, const Sphere& sphere) {
    const float3 to_center = sphere.center - ray.origin;
    const float along = dot(to_center, ray.direction);
    // The offset is measured from the nearest point of the ray to the centre: exact also for far
    // spheres.
    const float3 off = to_center - along * ray.direction;
    const float root = sphere.radius * sphere.radius - dot(off, off);
    const float distance = root < 0.0f ? -1.0f : along - std::sqrt(root);
    return distance > 0.0f ? distance : INFINITY;
}

bool meets_box(const Ray& ray, float3 inverse, float3 low, float3 high, float distance) {
    const float3 a = inverse * (low - ray.origin), b = inverse * (high - ray.origin);
    const float3 entry = smaller(a, b), exit = larger(a, b);
    return std::fmax(std::fmax(entry.x, entry.y), std::fmax(entry.z, 0.0f)) <=
           std::fmin(std::fmin(exit.x, exit.y), std::fmin(exit.z, distance));
}

Material floor_at(float3 point) {
    const bool dark = (static_cast<int>(std::floor(point.x) + std::floor(point.z)) & 1) != 0;
    const float albedo = dark ? 0.12f : 0.4f;
    return {{albedo, 0.9f * albedo, 0.8f * albedo}, {0.04f, 0.04f, 0.04f}, 0.2f};
}

}  // namespace

float3 Emitter::point(Random& random) const {
    const float root = std::sqrt(random.uniform()), v = root * random.uniform();
    return a + (1.0f - root) * (b - a) + v * (c - a);
}

Scene::Scene() {
    constexpr float3 kNone{0, 0, 0}, kGold{0.9f, 0.65f, 0.3f}, kSilver{0.8f, 0.8f, 0.85f};
    constexpr float3 kPlastic{0.04f, 0.04f, 0.04f};
    spheres_ = {{{-3.4f, 1, -1}, 1, {kNone, kGold, 0.1f}},
                {{-1.1f, 1, -2}, 1, {{0.1f, 0.35f, 0.15f}, kPlastic, 0.15f}},
                {{1.2f, 1, -2}, 1, {{0.6f, 0.55f, 0.5f}, kNone, 1.0f}},
                {{3.5f, 1, -1}, 1, {kNone, kSilver, 0.3f}},
                {{-1.6f, 0.5f, 1}, 0.5f, {{0.5f, 0.1f, 0.08f}, kPlastic, 0.3f}},
                {{0.1f, 0.5f, 1.4f}, 0.5f, {kNone, kSilver, 0.05f}},
                {{1.8f, 0.5f, 1}, 0.5f, {{0.1f, 0.15f, 0.5f}, kPlastic, 0.1f}}};
    hang_lanterns();
    build(0, static_cast<std::uint32_t>(emitters_.size()));
}

void Scene::hang_lanterns() {
    constexpr int kStrings = 25, kOnEach = 25;
    constexpr std::array<float3, 4> kColours{
        {{1, 0.55f, 0.2f}, {1, 0.3f, 0.15f}, {1, 0.8f, 0.5f}, {0.4f, 0.6f, 1}}};
    Random random(7);
    for (int i = 0; i < kStrings * kOnEach; ++i) {
        const int string = i / kOnEach, place = i % kOnEach;
        const float along = 2.0f * static_cast<float>(place) / (kOnEach - 1) - 1.0f;
        const float height = 2.6f + 0.8f * along * along + 0.2f * random.uniform();
        const float3 center{7.0f * along, height, 3.0f - 0.7f * static_cast<float>(string)};
        const float size = 0.05f + 0.04f * random.uniform();
        const float3 colour = kColours[static_cast<std::size_t>(4.0f * random.uniform())];
        const float3 radiance = 3.0f * std::exp(2.5f * random.uniform()) * colour;
        for (int face = 0; face < 8; ++face) {
            const float x = (face & 1) != 0 ? size : -size, y = (face & 2) != 0 ? size : -size;
            const float z = (face & 4) != 0 ? size : -size;
            Emitter triangle{center + float3{x, 0, 0}, center + float3{0, y, 0},
                             center + float3{0, 0, z}, radiance};
            if (x * y * z < 0.0f) std::swap(triangle.b, triangle.c);
            emitters_.push_back(triangle);
        }
    }
}

std::uint32_t Scene::build(std::uint32_t first, std::uint32_t count) {
    const auto begin = emitters_.begin() + first, end = begin + count;
    Node node{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, first, count};
    for (auto e = begin; e != end; ++e) {
        node.low = smaller(node.low, smaller(e->a, smaller(e->b, e->c)));
        node.high = larger(node.high, larger(e->a, larger(e->b, e->c)));
    }
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(node);
    if (count <= 4) return index;

    const float3 size = node.high - node.low;
    const auto longest = size.x >= size.y && size.x >= size.z ? &float3::x
                         : size.y >= size.z                   ? &float3::y
                                                              : &float3::z;
    const std::uint32_t half = count / 2;
    std::nth_element(begin, begin + half, end, [longest](const Emitter& e, const Emitter& f) {
        return (e.a + e.b + e.c).*longest < (f.a + f.b + f.c).*longest;
    });
    build(first, half);
    const std::uint32_t other = build(first + half, count - half);
    nodes_[index].first = other;
    nodes_[index].count = 0;
    return index;
}

void Scene::intersect_emitters(const Ray& ray, bool any, Hit& hit) const {
    const float3 inverse{1.0f / ray.direction.x, 1.0f / ray.direction.y, 1.0f / ray.direction.z};
    std::array<std::uint32_t, 32> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const std::uint32_t index = stack[--size];
        const Node& node = nodes_[index];
        if (!meets_box(ray, inverse, node.low, node.high, hit.distance)) continue;
        if (node.count == 0) {
            stack[size++] = node.first;
            stack[size++] = index + 1;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            const float distance = host::intersect(ray, emitters_[i]);
            if (distance >= hit.distance) continue;
            hit.distance = distance;
            hit.emitter = i;
            if (any) return;
        }
    }
}

float Scene::intersect_surfaces(const Ray& ray, const Sphere*& surface) const {
    constexpr float kHorizon = 1000.0f;
    surface = nullptr;
    float nearest = -ray.origin.y / ray.direction.y;
    if (!(nearest > 0.0f && nearest < kHorizon)) nearest = INFINITY;
    for (const Sphere& sphere : spheres_) {
        const float distance = host::intersect(ray, sphere);
        if (distance >= nearest) continue;
        nearest = distance;
        surface = &sphere;
    }
    return nearest;
}

Hit Scene::intersect(const Ray& ray) const {
    Hit hit;
    const Sphere* sphere;
    hit.distance = intersect_surfaces(ray, sphere);
    intersect_emitters(ray, false, hit);
    if (hit.emitter != Hit::kNoEmitter || hit.distance == INFINITY) return hit;
    const float3 point = ray.origin + hit.distance * ray.direction;
    if (sphere != nullptr) {
        hit.normal = normalize(point - sphere->center);
        hit.material = sphere->material;
    } else {
        hit.normal = {0, 1, 0};
        hit.material = floor_at(point);
    }
    return hit;
}

bool Scene::is_free(const Ray& ray, float distance) const {
    const Sphere* ignored;
    if (intersect_surfaces(ray, ignored) < distance) return false;
    Hit hit;
    hit.distance = distance;
    intersect_emitters(ray, true, hit);
    return hit.emitter == Hit::kNoEmitter;
}

Ray Scene::camera_ray(float x, float y) const {
    constexpr float3 kEye{0, 1.5f, 8};
    constexpr float kTilt = 0.02f, kHalfHeight = 0.4f;  // tangents of the view
    return {kEye, normalize({kHalfHeight * x, kHalfHeight * y - kTilt, -1.0f})};
}

float3 Scene::sky(float3 direction) const {
    const float up = std::fmax(direction.y, 0.0f), glow = std::pow(1.0f - up, 6.0f);
    return (1.0f - glow) * float3{0.01f, 0.02f, 0.06f} + glow * float3{0.16f, 0.09f, 0.08f};
}

}  // namespace host
