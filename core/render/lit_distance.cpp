#include "render/lit_distance.h"

#include "render/surface.h"
#include "render/warp.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace lightcull {
namespace {

/// As many as Embree traces at a time.
constexpr std::size_t kRays = 16;

/// The part of the light that falls on what is nearer than the distance.
constexpr double kNearer = 0.25;

/// Number i of a sequence that fills the unit interval evenly, and the unit square, if another one
/// is taken for its other coordinate: the powers of 1 / phi with phi^5 = phi + 1 (Roberts 2018,
/// "The unreasonable effectiveness of quasirandom sequences").
float spread(std::size_t i, int power) noexcept {
    const double step = std::pow(1.1673039782614187, -power);
    const double x = 0.5 + static_cast<double>(i + 1) * step;
    return static_cast<float>(x - std::floor(x));
}

/// The rays along which the triangle shines to one side.
std::vector<Ray> rays_from(const TriangleEmitter& emitter, bool back) {
    const V3f front = triangle_normal(emitter.edge1, emitter.edge2);
    const V3f normal = back ? -front : front;
    const V3f away = normal * clearance(normal, abs(emitter.corner), emitter.edge1, emitter.edge2);
    const Basis basis(normal);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < kRays; ++i) {
        const V2f b = uniform_triangle(V2f(spread(i, 1), spread(i, 2)));
        const V3f local = cosine_hemisphere(V2f(spread(i, 3), spread(i, 4)));
        rays.push_back({emitter.corner + emitter.edge1 * b.x + emitter.edge2 * b.y + away,
                        basis.to_world(local)});
    }
    return rays;
}

bool reflects(const SceneData& scene, std::uint32_t triangle) noexcept {
    const Material& m = scene.materials[scene.meshes[scene.triangles[triangle].mesh].material];
    return m.kind != MaterialKind::kDiffuse || max_component(to_v3f(m.base_color)) > 0.0f;
}

float distance_to_one_side(const SceneData& scene, const TriangleEmitter& emitter, bool back) {
    const std::vector<Ray> rays = rays_from(emitter, back);
    std::vector<Hit> hits(kRays);
    scene.ray_tracer->intersect(rays, hits, false);
    std::vector<float> distances;
    for (std::size_t i = 0; i < kRays; ++i) {
        if (hits[i].triangle == kNoHit || !reflects(scene, hits[i].triangle)) continue;
        distances.push_back((hit_position(scene, hits[i]) - rays[i].origin).length());
    }
    if (distances.empty()) return std::numeric_limits<float>::infinity();
    std::sort(distances.begin(), distances.end());
    return distances[static_cast<std::size_t>(kNearer * static_cast<double>(distances.size()))];
}

}  // namespace

float lit_distance(const SceneData& scene, const TriangleEmitter& emitter) {
    const float front = distance_to_one_side(scene, emitter, false);
    return emitter.two_sided ? std::min(front, distance_to_one_side(scene, emitter, true)) : front;
}

}  // namespace lightcull
