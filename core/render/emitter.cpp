#include "render/emitter.h"

#include "render/cut_outs.h"
#include "render/scene_data.h"
#include "render/spherical_triangle.h"
#include "render/texture.h"
#include "render/warp.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

namespace lightcull {
namespace {

/// A place as it is seen from a point.
struct Sight {
    V3f direction;
    float distance2;

    explicit Sight(const V3f& to_place) noexcept
        : direction(to_place), distance2(to_place.dot(to_place)) {
        direction *= 1.0f / std::sqrt(distance2);
    }
};

/// Density per solid angle of a place that is uniform by area.
float pdf_by_area(const TriangleEmitter& emitter, const Sight& place) noexcept {
    // |normal| is twice the area, so that distance^2 / (cosine * area) becomes this. No third power
    // of a length is formed, which floats could not hold.
    const V3f normal = emitter.edge1.cross(emitter.edge2);
    const float pdf = place.distance2 / (0.5f * std::fabs(normal.dot(place.direction)));
    return std::isfinite(pdf) ? pdf : 0.0f;
}

/// The triangle as it is seen from a point that is near enough for places uniform by area to be
/// noisy: nearer than three times its size. Nothing where it is seen edge-on, or the point is in
/// its plane.
std::optional<SphericalTriangle> as_seen_from_near(const TriangleEmitter& emitter,
                                                   const V3f& from) noexcept {
    constexpr float kNear = 3.0f;
    const V3f a = emitter.corner - from;
    const V3f& e1 = emitter.edge1;
    const V3f& e2 = emitter.edge2;
    const float size2 = std::max(e1.dot(e1), e2.dot(e2));
    if (a.dot(a) > (kNear + 1.0f) * (kNear + 1.0f) * size2) return std::nullopt;
    // On the triangle itself rounding would decide what is seen.
    const V3f normal = triangle_normal(e1, e2);
    if (std::fabs(normal.dot(a)) <= clearance(normal, abs(from) + abs(emitter.corner), e1, e2)) {
        return std::nullopt;
    }
    constexpr double kLeast = 1e-6;
    const V3d corner(a);
    const SphericalTriangle seen(corner, corner + V3d(e1), corner + V3d(e2));
    if (!(seen.solid_angle() > kLeast)) return std::nullopt;
    return seen;
}

/// The barycentric coordinates of the place where a direction from a point meets the triangle.
V2f hit_by(const TriangleEmitter& emitter, const V3f& from, const V3d& direction) noexcept {
    const V3d e1(emitter.edge1), e2(emitter.edge2), away = V3d(from) - V3d(emitter.corner);
    const V3d across = direction.cross(e2), around = away.cross(e1);
    const double scale = 1.0 / e1.dot(across);
    const double x = std::clamp(away.dot(across) * scale, 0.0, 1.0);
    const double y = std::clamp(direction.dot(around) * scale, 0.0, 1.0 - x);
    return {static_cast<float>(x), static_cast<float>(y)};
}

struct Sampler {
    const SceneData& scene;
    const V3f& from;
    const PlaceNumbers& u;

    EmitterSample operator()(const TriangleEmitter& emitter) const noexcept {
        if (has_pieces(emitter)) return on_piece(emitter);
        const auto seen = as_seen_from_near(emitter, from);
        const V2f b =
            seen ? hit_by(emitter, from, seen->sample(u.place)) : uniform_triangle(u.place);
        return look_at(emitter, b, emitter, b, seen);
    }

    EmitterSample on_piece(const TriangleEmitter& whole) const noexcept {
        const TriangleCuts::Piece piece = scene.cuts.draw(whole.part, u.piece);
        const TriangleEmitter emitter = part_of(whole, piece.corners);
        const auto seen = as_seen_from_near(emitter, from);
        const V2f b =
            seen ? hit_by(emitter, from, seen->sample(u.place)) : draw_place(piece, u.place);
        const float2 in_whole = place_in(piece.corners, {b.x, b.y});
        EmitterSample sample = look_at(emitter, b, whole, {in_whole.x, in_whole.y}, seen);
        sample.pdf *= piece.prob;
        if (!seen) sample.pdf *= TriangleCuts::density(piece, {b.x, b.y});
        return sample;
    }

    static V2f draw_place(const TriangleCuts::Piece& piece, const V2f& u) noexcept {
        const float2 place = TriangleCuts::draw_place(piece, u.x, u.y);
        return {place.x, place.y};
    }

    /// Looks at a place `b` of an emitter or a piece, which is `in_whole` in all of the triangle.
    EmitterSample look_at(const TriangleEmitter& emitter, const V2f& b,
                          const TriangleEmitter& whole, const V2f& in_whole,
                          const std::optional<SphericalTriangle>& seen) const noexcept {
        const V3f place = emitter.corner + emitter.edge1 * b.x + emitter.edge2 * b.y;
        const Sight sight(place - from);
        if (!(sight.distance2 > 0.0f)) return {};
        const float pdf =
            seen ? static_cast<float>(1.0 / seen->solid_angle()) : pdf_by_area(emitter, sight);
        if (!(pdf > 0.0f)) return {};
        const V3f radiance =
            emitted_on_average(scene, whole, in_whole.x, in_whole.y, -sight.direction);
        return {place, sight.direction, radiance, pdf, false, emitter.triangle};
    }

    EmitterSample operator()(const PointEmitter& emitter) const noexcept {
        return from_point(emitter.position, emitter.intensity);
    }

    EmitterSample operator()(const SpotEmitter& emitter) const noexcept {
        EmitterSample s = from_point(emitter.position, emitter.intensity);
        s.radiance *= spot_falloff(emitter, versine(-s.direction, emitter.direction));
        return s;
    }

    EmitterSample operator()(const DirectionalEmitter& emitter) const noexcept {
        EmitterSample s{V3f(0.0f), -emitter.direction, emitter.irradiance, 1.0f, true};
        s.at_infinity = true;
        return s;
    }

    EmitterSample operator()(const VirtualEmitter& emitter) const noexcept {
        const VirtualLight& light = scene.virtual_lights[emitter.index];
        const Sight sight(light.position - from);
        if (!(sight.distance2 > 0.0f)) return {};
        const V3f sent = intensity(light, -sight.direction);
        const float distance2 = std::max(sight.distance2, scene.virtual_nearest2);
        return {light.position, sight.direction, sent / distance2, 1.0f, true};
    }

    EmitterSample from_point(const V3f& position, const V3f& intensity) const noexcept {
        const Sight sight(position - from);
        if (!(sight.distance2 > 0.0f)) return {};
        return {position, sight.direction, intensity / sight.distance2, 1.0f, true};
    }
};

}  // namespace

EmitterSample sample_emitter(const SceneData& scene, const Emitter& emitter, const V3f& from,
                             const PlaceNumbers& u) noexcept {
    // This is not std::visit, which may throw.
    const Sampler sample{scene, from, u};
    if (const auto* triangle = std::get_if<TriangleEmitter>(&emitter)) return sample(*triangle);
    if (const auto* point = std::get_if<PointEmitter>(&emitter)) return sample(*point);
    if (const auto* spot = std::get_if<SpotEmitter>(&emitter)) return sample(*spot);
    if (const auto* sun = std::get_if<DirectionalEmitter>(&emitter)) return sample(*sun);
    return sample(*std::get_if<VirtualEmitter>(&emitter));
}

float spot_falloff(const SpotEmitter& emitter, float versine) noexcept {
    if (versine <= emitter.inner) return 1.0f;
    if (versine >= emitter.outer) return 0.0f;
    const float ramp = (emitter.outer - versine) / (emitter.outer - emitter.inner);
    return ramp * ramp;
}

float triangle_pdf(const TriangleEmitter& emitter, const V3f& from, const V3f& to_place) noexcept {
    const auto seen = as_seen_from_near(emitter, from);
    return seen ? static_cast<float>(1.0 / seen->solid_angle())
                : pdf_by_area(emitter, Sight(to_place));
}

PlacePdf place_pdf(const SceneData& scene, std::uint32_t light, float2 place, const V3f& from,
                   const V3f& to_place) noexcept {
    const auto& emitter = *std::get_if<TriangleEmitter>(&scene.emitters[light]);
    if (emitter.part == kNone) return {light, triangle_pdf(emitter, from, to_place)};
    const std::uint32_t triangle = scene.cuts.parts()[emitter.part].triangle;
    const auto [piece, in_piece] = scene.cuts.at(triangle, place);
    if (piece.part == TriangleCuts::kNoPart) return {light, 0.0f};
    const std::uint32_t of_part = scene.part_lights[piece.part];
    if (has_pieces(emitter)) {
        const TriangleEmitter on_piece = part_of(emitter, piece.corners);
        const auto seen = as_seen_from_near(on_piece, from);
        if (seen) return {of_part, piece.prob * static_cast<float>(1.0 / seen->solid_angle())};
        const float density = piece.prob * TriangleCuts::density(piece, in_piece);
        return {of_part, density * pdf_by_area(on_piece, Sight(to_place))};
    }
    const auto& part = *std::get_if<TriangleEmitter>(&scene.emitters[of_part]);
    return {of_part, triangle_pdf(part, from, to_place)};
}

TriangleEmitter part_of(const TriangleEmitter& whole, const SubTriangle& part) noexcept {
    const float2 o = part.corners[0], p = part.corners[1], q = part.corners[2];
    TriangleEmitter result = whole;
    result.corner += whole.edge1 * o.x + whole.edge2 * o.y;
    result.edge1 = whole.edge1 * (p.x - o.x) + whole.edge2 * (p.y - o.y);
    result.edge2 = whole.edge1 * (q.x - o.x) + whole.edge2 * (q.y - o.y);
    return result;
}

V3f emitted(const SceneData& scene, const TriangleEmitter& emitter, float u, float v,
            const V3f& direction) noexcept {
    if (!emitter.two_sided && emitter.edge1.cross(emitter.edge2).dot(direction) <= 0.0f) {
        return V3f(0.0f);
    }
    if (!emitter.has_texture) return emitter.radiance;
    const TextureId texture = scene.meshes[scene.triangles[emitter.triangle].mesh].emission_texture;
    return emitter.radiance * lookup(scene.textures[texture], scene.uv_at(emitter.triangle, u, v));
}

V3f emitted_on_average(const SceneData& scene, const TriangleEmitter& emitter, float u, float v,
                       const V3f& direction) noexcept {
    const V3f radiance = emitted(scene, emitter, u, v, direction);
    return scene.has_cut_outs ? radiance * opacity_at(scene, emitter.triangle, u, v) : radiance;
}

}  // namespace lightcull
