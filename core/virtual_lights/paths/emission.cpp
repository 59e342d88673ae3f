#include "virtual_lights/paths/emission.h"

#include "render/warp.h"

#include <ImathBox.h>
#include <cmath>
#include <vector>

namespace lightcull {
namespace {

/// A direction about an axis, and the versine of the angle between them.
struct ConeSample {
    V3f direction;
    float versine;
};

/// Uniform over the directions whose angles to the axis have at most the versine `largest`.
ConeSample uniform_cone(const V3f& axis, float largest, const V2f& u) noexcept {
    const V2f disk = uniform_disk(u);
    const float versine = largest * disk.dot(disk);
    const float stretch = std::sqrt(largest * std::max(0.0f, 2.0f - versine));
    return {Basis(axis).to_world({disk.x * stretch, disk.y * stretch, 1.0f - versine}), versine};
}

LightRay point_ray(const PointEmitter& point, const V2f& u) noexcept {
    const ConeSample all_around = uniform_cone(V3f(0.0f, 0.0f, 1.0f), 2.0f, u);
    return {{point.position, all_around.direction}, point.intensity * (4.0f * kPi)};
}

LightRay triangle_ray(const SceneData& scene, const TriangleEmitter& emitter,
                      const PathRandom& random) noexcept {
    const V2f u = random.two(Dimension::kLightVertex);
    TriangleEmitter triangle = emitter;
    V2f b = uniform_triangle(u), in_whole = b;
    float pdf = 1.0f;
    if (has_pieces(emitter)) {
        const double of_piece = random.fine(Dimension::kLightPiece);
        const TriangleCuts::Piece piece = scene.cuts.draw(emitter.part, of_piece);
        triangle = part_of(emitter, piece.corners);
        const float2 on_piece = TriangleCuts::draw_place(piece, u.x, u.y);
        const float2 place = place_in(piece.corners, on_piece);
        b = {on_piece.x, on_piece.y};
        in_whole = {place.x, place.y};
        pdf = piece.prob * TriangleCuts::density(piece, on_piece);
    }
    const V3f front = triangle_normal(triangle.edge1, triangle.edge2);
    const bool is_back = triangle.two_sided && random.one(Dimension::kLobe) < 0.5f;
    const V3f normal = is_back ? -front : front;
    const V3f place =
        triangle.corner + triangle.edge1 * b.x + triangle.edge2 * b.y +
        normal * clearance(normal, abs(triangle.corner), triangle.edge1, triangle.edge2);
    const V3f local = cosine_hemisphere(random.two(Dimension::kScatter));
    const V3f direction = Basis(normal).to_world(local);
    const float area = 0.5f * front.dot(triangle.edge1.cross(triangle.edge2));
    const float sides = triangle.two_sided ? 2.0f : 1.0f;
    return {{place, direction},
            emitted_on_average(scene, emitter, in_whole.x, in_whole.y, normal) *
                (kPi * area * sides / pdf)};
}

/// The power of an emitter, W; radius: that of a sphere around the scene, which a sun lights.
double power(const Emitter& emitter, const Light& light, float radius) noexcept {
    if (light.directional) {
        const auto r = static_cast<double>(radius);
        return static_cast<double>(kPi) * r * r * static_cast<double>(light.intensity);
    }
    const double of_unit = static_cast<double>(kPi) * static_cast<double>(light.intensity);
    if (std::get_if<PointEmitter>(&emitter) != nullptr) return 4.0 * of_unit;
    if (const auto* spot = std::get_if<SpotEmitter>(&emitter)) {
        const auto inner = static_cast<double>(spot->inner);
        const auto outer = static_cast<double>(spot->outer);
        return 2.0 * of_unit * (inner + (outer - inner) / 3.0);
    }
    return light.two_sided ? 2.0 * of_unit : of_unit;
}

/// The flux that the environment gives per area that faces each direction in turn, by luminance,
/// W/m^2.
double irradiance(const EnvironmentMap& environment) noexcept {
    constexpr int kSamples = 256;
    double sum = 0.0;
    for (int i = 0; i < kSamples; ++i) {
        const EnvironmentSample s = environment.sample((i + 0.5) / kSamples, V2f(0.5f));
        if (s.pdf > 0.0f) sum += static_cast<double>(luminance(s.radiance) / s.pdf);
    }
    return sum / kSamples;
}

}  // namespace

EmissionTable::EmissionTable(const SceneData& scene) : scene_(scene) {
    Imath::Box3f box;
    scene.for_each_placed([&](MeshId mesh, std::uint32_t instance) {
        if (instance != kNotInstanced) {
            box.extendBy(bounds_of(scene, scene.instances[instance]));
            return;
        }
        const SceneData::Range range = scene.positions_of(mesh);
        for (std::size_t i = range.begin; i < range.end; ++i) box.extendBy(scene.positions[i]);
    });
    if (!box.isEmpty()) {
        center_ = box.center();
        radius_ = 0.5f * box.size().length();
    }
    std::vector<double> powers;
    double sum = 0.0;
    for (std::size_t i = 0; i < scene.emitters.size(); ++i) {
        powers.push_back(power(scene.emitters[i], scene.lights[i], radius_));
    }
    powers.push_back(scene.environment ? irradiance(*scene.environment) *
                                             static_cast<double>(kPi * radius_ * radius_)
                                       : 0.0);
    for (const double p : powers) sum += p;
    if (sum > 0.0) table_ = AliasTable(powers);
}

LightRay EmissionTable::sample(const PathRandom& random) const noexcept {
    const std::uint32_t chosen = table_.sample(random.fine(Dimension::kSelectLight));
    LightRay result;
    if (chosen == scene_.emitters.size()) {
        result = environment_ray(random, random.two(Dimension::kLightVertex));
    } else if (const auto* spot = std::get_if<SpotEmitter>(&scene_.emitters[chosen])) {
        result = spot_ray(*spot, random.two(Dimension::kLightVertex));
    } else if (const auto* point = std::get_if<PointEmitter>(&scene_.emitters[chosen])) {
        result = point_ray(*point, random.two(Dimension::kLightVertex));
    } else if (const auto* sun = std::get_if<DirectionalEmitter>(&scene_.emitters[chosen])) {
        result = directional_ray(*sun, random.two(Dimension::kLightVertex));
    } else {
        result =
            triangle_ray(scene_, *std::get_if<TriangleEmitter>(&scene_.emitters[chosen]), random);
    }
    result.flux /= table_.prob(chosen);
    return result;
}

LightRay EmissionTable::environment_ray(const PathRandom& random, const V2f& u) const noexcept {
    const EnvironmentSample s = scene_.environment->sample(random.fine(Dimension::kEnvironment),
                                                           random.two(Dimension::kInCell));
    if (!(s.pdf > 0.0f)) return {{center_, V3f(0.0f, 0.0f, 1.0f)}, V3f(0.0f)};
    return {parallel_ray(-s.direction, u), s.radiance * (kPi * radius_ * radius_ / s.pdf)};
}

LightRay EmissionTable::directional_ray(const DirectionalEmitter& sun,
                                        const V2f& u) const noexcept {
    return {parallel_ray(sun.direction, u), sun.irradiance * (kPi * radius_ * radius_)};
}

Ray EmissionTable::parallel_ray(const V3f& direction, const V2f& u) const noexcept {
    const Basis basis(direction);
    const V2f disk = uniform_disk(u) * radius_;
    const V3f origin =
        center_ - direction * radius_ + basis.tangent * disk.x + basis.bitangent * disk.y;
    return {origin, direction};
}

LightRay spot_ray(const SpotEmitter& spot, const V2f& u) noexcept {
    const ConeSample s = uniform_cone(spot.direction, spot.outer, u);
    const float solid_angle = 2.0f * kPi * spot.outer;
    return {{spot.position, s.direction},
            spot.intensity * (spot_falloff(spot, s.versine) * solid_angle)};
}

}  // namespace lightcull
