#include "render/emitter_cuts.h"

#include "render/emitter_place.h"
#include "render/lit_distance.h"
#include "render/texture.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace lightcull {
namespace {

/// Of the triangles without a texture, how many are looked at for each light that may be added:
/// those that emit most.
constexpr std::size_t kLookedAt = 4;

/// The least density at a corner of a piece, as a part of that of all three: the interpolation of
/// the texture is not quite linear.
constexpr float kLeastDensity = 0.05f;

float lit(const Texture& texture, const V2f& uv) noexcept {
    return luminance(lookup(texture, uv));
}

/// The longest edge of a triangle of texture coordinates, in texels.
float longest_edge(const Texture& texture, const V2f& u, const V2f& v, const V2f& w) noexcept {
    const V2f texels(static_cast<float>(texture.width), static_cast<float>(texture.height));
    return std::max(
        {((v - u) * texels).length(), ((w - v) * texels).length(), ((u - w) * texels).length()});
}

const TriangleEmitter* triangle_of(const Emitter& emitter) noexcept {
    return std::get_if<TriangleEmitter>(&emitter);
}

/// The emissive triangles of a scene that may be cut, and what asks for it.
class Cutting {
  public:
    explicit Cutting(SceneData& scene);

    void cut();

  private:
    void choose_candidates();
    const TriangleEmitter& emitter_of(std::uint32_t candidate) const noexcept {
        return *triangle_of(scene_.emitters[candidates_[candidate]]);
    }
    PartEmission emission(std::uint32_t candidate, const SubTriangle& part);
    PartEmission of_texture(const TriangleEmitter& emitter, const SubTriangle& part);
    bool is_within_texel(const TriangleEmitter& emitter) const noexcept;
    void take_over();

    SceneData& scene_;
    CutLimits limits_;
    std::vector<std::uint32_t> candidates_;  ///< lights, in order
    std::map<TextureId, TextureMean> squares_;
};

Cutting::Cutting(SceneData& scene) : scene_(scene), limits_(cut_limits(scene.lights)) {
    choose_candidates();
}

void Cutting::choose_candidates() {
    std::vector<std::uint32_t> plain;
    for (std::uint32_t i = 0; i < scene_.emitters.size(); ++i) {
        const TriangleEmitter* const triangle = triangle_of(scene_.emitters[i]);
        if (triangle == nullptr || !(scene_.lights[i].intensity > 0.0f)) continue;
        if (!triangle->has_texture) {
            plain.push_back(i);
        } else if (!is_within_texel(*triangle) || of_texture(*triangle, {}).mean > 0.0f) {
            // Else it has so little of the texture that means of parts are lost in rounding.
            candidates_.push_back(i);
        }
    }
    const std::size_t most = kLookedAt * limits_.most_lights;
    if (plain.size() > most) {
        const auto emits_more = [this](std::uint32_t a, std::uint32_t b) {
            const float of_a = scene_.lights[a].intensity, of_b = scene_.lights[b].intensity;
            return of_a != of_b ? of_a > of_b : a < b;
        };
        std::nth_element(plain.begin(), plain.begin() + static_cast<std::ptrdiff_t>(most),
                         plain.end(), emits_more);
        plain.resize(most);
    }
    candidates_.insert(candidates_.end(), plain.begin(), plain.end());
    std::sort(candidates_.begin(), candidates_.end());
}

PartEmission Cutting::emission(std::uint32_t candidate, const SubTriangle& part) {
    const TriangleEmitter& emitter = emitter_of(candidate);
    PartEmission emission;
    emission.mean = 1.0f;
    if (emitter.has_texture) emission = of_texture(emitter, part);
    emission.mean *= luminance(emitter.radiance);
    return emission;
}

bool Cutting::is_within_texel(const TriangleEmitter& emitter) const noexcept {
    const TextureId id = scene_.meshes[scene_.triangles[emitter.triangle].mesh].emission_texture;
    const auto uv_at = [&](float u, float v) { return scene_.uv_at(emitter.triangle, u, v); };
    return longest_edge(scene_.textures[id], uv_at(0, 0), uv_at(1, 0), uv_at(0, 1)) <= 1.0f;
}

PartEmission Cutting::of_texture(const TriangleEmitter& emitter, const SubTriangle& part) {
    const TextureId id = scene_.meshes[scene_.triangles[emitter.triangle].mesh].emission_texture;
    const Texture& texture = scene_.textures[id];
    const TextureMean& mean_of = scene_.texture_means.at(id);
    const auto uv_at = [&](float2 place) {
        return scene_.uv_at(emitter.triangle, place.x, place.y);
    };
    const auto [a, b, c] = part.corners;
    const V2f u = uv_at(a), v = uv_at(b), w = uv_at(c);
    const float mean = mean_of.over_part(u, v, w);
    if (!(mean > 0.0f)) return {};

    const float longest = longest_edge(texture, u, v, w);
    if (longest > 1.0f) {
        // The mean of interpolated squares is not below that of squares of what is interpolated.
        const TextureMean& square_of =
            squares_.try_emplace(id, texture, TextureMean::Of::kSquare).first->second;
        const float square = square_of.over_part(u, v, w);
        constexpr float kMost = 1e9f;
        return {mean, {1.0f, 1.0f, 1.0f}, std::clamp(square / mean / mean - 1.0f, 0.0f, kMost)};
    }
    // Within a texel the texture is smooth: its corners and quarters tell.
    const float p = lit(texture, u), q = lit(texture, v), r = lit(texture, w);
    const float least = kLeastDensity * (p + q + r);
    PartEmission emission{mean, {std::max(p, least), std::max(q, least), std::max(r, least)}, 0.0f};
    const auto& d = emission.densities;
    const float third = (d[0] + d[1] + d[2]) / 3.0f;
    if (!(third > 0.0f)) return {mean, {1.0f, 1.0f, 1.0f}, 1.0f};
    const V2f uv = (u + v) * 0.5f, vw = (v + w) * 0.5f, wu = (w + u) * 0.5f;
    const auto square = [&](const V2f& i, const V2f& j, const V2f& k, float density) {
        const float of_quarter = mean_of.over_part(i, j, k) / mean;
        return 0.25f * of_quarter * of_quarter * third / density;
    };
    const auto next_to = [&](int corner) { return 0.5f * (third + d[corner]); };
    const float squares = square(u, uv, wu, next_to(0)) + square(uv, v, vw, next_to(1)) +
                          square(wu, vw, w, next_to(2)) + square(uv, vw, wu, third);
    emission.unevenness = std::max(0.0f, squares - 1.0f);
    return emission;
}

void Cutting::cut() {
    std::vector<TriangleCorners> triangles;
    for (const std::uint32_t light : candidates_) {
        const TriangleEmitter& t = *triangle_of(scene_.emitters[light]);
        triangles.push_back(
            {to_float3(t.corner), to_float3(t.corner + t.edge1), to_float3(t.corner + t.edge2)});
    }
    CutDemand demand;
    demand.emission = [this](std::uint32_t i, const SubTriangle& part) {
        return emission(i, part);
    };
    demand.distance = [this](std::uint32_t i, const SubTriangle& part) {
        return lit_distance(scene_, part_of(emitter_of(i), part));
    };
    demand.least_flux = limits_.least_flux;
    demand.most_lights = limits_.most_lights;
    scene_.cuts = TriangleCuts(triangles, demand);
    take_over();
}

/// Gives the parts to the scene.
void Cutting::take_over() {
    const Span<const TriangleCuts::Part> parts = scene_.cuts.parts();
    scene_.part_lights.assign(parts.size(), kNone);
    scene_.mean_radiances.resize(scene_.lights.size());
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
        std::uint32_t light = candidates_[parts[i].triangle];
        if (!scene_.cuts.is_cut(parts[i].triangle)) {
            if (parts[i].radiance == 0.0f) {
                scene_.mean_radiances[light] = scene_.lights[light].intensity = 0.0f;
            }
            continue;
        }
        TriangleEmitter part = emitter_of(parts[i].triangle);
        part.part = i;
        if (i > 0 && parts[i - 1].triangle == parts[i].triangle) {
            light = static_cast<std::uint32_t>(scene_.lights.size());
            scene_.lights.emplace_back();
            scene_.emitters.emplace_back();
            scene_.mean_radiances.emplace_back();
            ++scene_.further_parts;
        }
        scene_.emitters[light] = part;
        scene_.mean_radiances[light] = parts[i].radiance;
        place_triangle_light(scene_, light);
        scene_.part_lights[i] = light;
    }
}

}  // namespace

void cut_emitters(SceneData& scene) {
    Cutting(scene).cut();
}

}  // namespace lightcull
