#pragma once

// The host's own scene: spheres on a floor at dusk, under strings of 625 lanterns. A lantern is an
// octahedron, so that there are 5,000 emissive triangles. Nothing here knows of light sampling.

#include <cstdint>
#include <vector>

#include "vectors.h"

namespace host {

struct Ray {
    float3 origin, direction;
};

/// A material that reflects: a diffuse part, and a GGX lobe.
struct Material {
    float3 albedo;       ///< albedo of the diffuse part
    float3 reflectance;  ///< reflectance of the GGX lobe, towards the normal
    float alpha;         ///< roughness of the GGX lobe
};

struct Sphere {
    float3 center;
    float radius;
    Material material;
};

/// A triangle that shines on the side from which a, b, c run anticlockwise, and reflects nothing.
struct Emitter {
    float3 a, b, c;
    float3 radiance;

    float3 point(Random& random) const;  ///< uniform over the triangle
    float3 normal_times_area() const { return 0.5f * cross(b - a, c - a); }
};

struct Hit {
    static constexpr std::uint32_t kNoEmitter = 0xffffffffu;

    float distance = INFINITY;  ///< distance along the ray, infinite where it leaves the scene
    float3 normal;              ///< normal towards the ray's origin; not set for emitters
    Material material;          ///< material; not set for emitters
    std::uint32_t emitter = kNoEmitter;
};

class Scene {
  public:
    Scene();

    const std::vector<Emitter>& emitters() const { return emitters_; }

    /// The first surface along a ray.
    Hit intersect(const Ray& ray) const;
    /// True if nothing lies between the ray's origin and that distance.
    bool is_free(const Ray& ray, float distance) const;

    /// The ray through a place on a film that goes from -1 to 1 up and down.
    Ray camera_ray(float x, float y) const;
    /// The environment: radiance that comes from a direction.
    float3 sky(float3 direction) const;

  private:
    /// A node of a binary tree of boxes. A leaf holds emitters first to first + count; other nodes
    /// have a count of 0, one child is the next node, and the other is `first`.
    struct Node {
        float3 low, high;
        std::uint32_t first, count;
    };

    void hang_lanterns();
    std::uint32_t build(std::uint32_t first, std::uint32_t count);
    /// Sets hit.emitter and hit.distance to the first emitter before hit.distance, or, if any will
    /// do, to one.
    void intersect_emitters(const Ray& ray, bool any, Hit& hit) const;
    /// The distance to the nearest sphere or to the floor, whichever `surface` is set to.
    float intersect_surfaces(const Ray& ray, const Sphere*& surface) const;

    std::vector<Sphere> spheres_;
    std::vector<Emitter> emitters_;  // emitters in the order of the tree's leaves
    std::vector<Node> nodes_;
};

}  // namespace host
