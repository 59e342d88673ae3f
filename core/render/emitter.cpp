#include "render/emitter.h"

#include "render/scene_data.h"
#include "render/texture.h"
#include "render/warp.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace lightcull {
namespace {

struct Sampler {
    const SceneData& scene;
    const V3f& from;
    V2f u;

    EmitterSample operator()(const TriangleEmitter& emitter) const noexcept {
        const V2f b = uniform_triangle(u);
        const V3f place = emitter.corner + emitter.edge1 * b.x + emitter.edge2 * b.y;
        const V3f to_place = place - from;
        const float distance2 = to_place.dot(to_place);
        if (!(distance2 > 0.0f)) return {};
        const float pdf = triangle_pdf(emitter, to_place);
        if (!(pdf > 0.0f)) return {};
        const V3f direction = to_place / std::sqrt(distance2);
        const V3f radiance = emitted(scene, emitter, b.x, b.y, -direction);
        return {place, direction, radiance, pdf, false, emitter.triangle};
    }

    EmitterSample operator()(const PointEmitter& emitter) const noexcept {
        return from_point(emitter.position, emitter.intensity);
    }

    EmitterSample operator()(const SpotEmitter& emitter) const noexcept {
        EmitterSample s = from_point(emitter.position, emitter.intensity);
        s.radiance *= spot_falloff(emitter, versine(-s.direction, emitter.direction));
        return s;
    }

    EmitterSample operator()(const VirtualEmitter& emitter) const noexcept {
        const VirtualLight& light = scene.virtual_lights[emitter.index];
        const V3f to_place = light.position - from;
        const float distance2 = to_place.dot(to_place);
        if (!(distance2 > 0.0f)) return {};
        const V3f direction = to_place / std::sqrt(distance2);
        const V3f sent = intensity(light, -direction);
        return {light.position, direction, sent / std::max(distance2, scene.virtual_nearest2), 1.0f,
                true};
    }

    EmitterSample from_point(const V3f& position, const V3f& intensity) const noexcept {
        const V3f to_place = position - from;
        const float distance2 = to_place.dot(to_place);
        if (!(distance2 > 0.0f)) return {};
        return {position, to_place / std::sqrt(distance2), intensity / distance2, 1.0f, true};
    }
};

}  // namespace

EmitterSample sample_emitter(const SceneData& scene, const Emitter& emitter, const V3f& from,
                             const V2f& u) noexcept {
    // This is not std::visit, which may throw.
    const Sampler sample{scene, from, u};
    if (const auto* triangle = std::get_if<TriangleEmitter>(&emitter)) return sample(*triangle);
    if (const auto* point = std::get_if<PointEmitter>(&emitter)) return sample(*point);
    if (const auto* spot = std::get_if<SpotEmitter>(&emitter)) return sample(*spot);
    return sample(*std::get_if<VirtualEmitter>(&emitter));
}

float spot_falloff(const SpotEmitter& emitter, float versine) noexcept {
    if (versine <= emitter.inner) return 1.0f;
    if (versine >= emitter.outer) return 0.0f;
    const float ramp = (emitter.outer - versine) / (emitter.outer - emitter.inner);
    return ramp * ramp;
}

float triangle_pdf(const TriangleEmitter& emitter, const V3f& to_place) noexcept {
    // |normal| is twice the area, so that distance^2 / (cosine * area) becomes this. No third power
    // of a length is formed, which floats could not hold.
    const V3f normal = emitter.edge1.cross(emitter.edge2);
    const float distance2 = to_place.dot(to_place);
    const float projected = 0.5f * std::fabs(normal.dot(to_place / std::sqrt(distance2)));
    const float pdf = distance2 / projected;
    return std::isfinite(pdf) ? pdf : 0.0f;
}

V3f emitted(const SceneData& scene, const TriangleEmitter& emitter, float u, float v,
            const V3f& direction) noexcept {
    if (!emitter.two_sided && emitter.edge1.cross(emitter.edge2).dot(direction) <= 0.0f) {
        return V3f(0.0f);
    }
    if (emitter.texture == kNoTexture) return emitter.radiance;
    return emitter.radiance *
           lookup(scene.textures[emitter.texture], scene.uv_at(emitter.triangle, u, v));
}

}  // namespace lightcull
