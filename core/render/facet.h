#pragma once

#include "render/ray.h"
#include "render/scene_data.h"
#include "render/vec.h"

#include <algorithm>
#include <cstdint>

namespace lightcull {

/// A triangle in its place.
struct Facet {
    Facet(const SceneData& scene, std::uint32_t triangle, std::uint32_t instance) noexcept
        : a(scene.positions[scene.corner(triangle, 0)]),
          b(scene.positions[scene.corner(triangle, 1)]),
          c(scene.positions[scene.corner(triangle, 2)]) {
        if (instance == kNotInstanced) {
            magnitude = largest(abs(a), abs(b), abs(c));
        } else {
            place(scene.instances[instance]);
        }
        edge1 = b - a;
        edge2 = c - a;
    }

    V3f at(float u, float v) const noexcept { return a * (1.0f - u - v) + b * u + c * v; }

    V3f a, b, c;
    V3f edge1, edge2;          ///< edges from a to b and to c
    V3f magnitude;             ///< bounds what clearance() takes for the corners' coordinates
    bool is_mirrored = false;  ///< its corners run the other way round than the mesh's

  private:
    static V3f largest(const V3f& p, const V3f& q, const V3f& r) noexcept {
        return V3f(std::max(std::max(p.x, q.x), r.x), std::max(std::max(p.y, q.y), r.y),
                   std::max(std::max(p.z, q.z), r.z));
    }

    void place(const Instance& instance) noexcept {
        // Embree takes rays to the mesh, which rounds them once more.
        constexpr float kRoundings = 4.0f;
        magnitude =
            largest(instance.magnitude_at(a), instance.magnitude_at(b), instance.magnitude_at(c)) *
            kRoundings;
        a = instance.at(a);
        b = instance.at(b);
        c = instance.at(c);
        is_mirrored = instance.is_mirrored;
    }
};

}  // namespace lightcull
