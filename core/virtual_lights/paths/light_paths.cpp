#include "virtual_lights/paths/light_paths.h"

#include "base/parallel_blocks.h"
#include "render/morton_sort.h"

#include <lightcull/error.h>

#include <algorithm>
#include <numeric>

namespace lightcull {
namespace {

constexpr std::size_t kBlock = 4096;

/// The paths of one block, one edge at a time.
class LightPaths {
  public:
    LightPaths(const SceneData& scene, const LightRay* starts, std::size_t count,
               std::uint32_t first, std::uint64_t key)
        : scene_(scene), key_(key), numbers_(count) {
        std::iota(numbers_.begin(), numbers_.end(), first);
        for (std::size_t i = 0; i < count; ++i) {
            rays_.push_back(starts[i].ray);
            fluxes_.push_back(starts[i].flux);
        }
    }

    /// Traces an edge of all paths, and leaves a light where each one ends.
    void advance(std::uint32_t depth, std::vector<VirtualLight>& lights) {
        hits_.resize(rays_.size());
        scene_.ray_tracer->intersect(rays_, hits_, false);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            if (hits_[i].triangle == kNoHit) continue;
            const Surface surface = make_surface(scene_, hits_[i], rays_[i].direction);
            add_virtual_lights(surface, -rays_[i].direction, fluxes_[i], lights);
            LightRay next{rays_[i], fluxes_[i]};
            if (!scatter(surface, {key_, numbers_[i], depth}, next)) continue;
            rays_[kept] = next.ray;
            fluxes_[kept] = next.flux;
            numbers_[kept++] = numbers_[i];
        }
        rays_.resize(kept);
        fluxes_.resize(kept);
        numbers_.resize(kept);
    }

  private:
    /// Absorbs as many paths as the surface absorbs of the flux, so that lights stay about equal.
    static bool scatter(const Surface& surface, const PathRandom& random, LightRay& path) noexcept {
        const BsdfSample s =
            surface.bsdf.sample(random.one(Dimension::kLobe), random.two(Dimension::kScatter));
        if (!(s.pdf > 0.0f) || s.direction.dot(surface.normal) <= 0.0f) return false;
        const V3f flux = path.flux * s.weight;
        const float survival = std::min(1.0f, max_component(flux) / max_component(path.flux));
        if (!(random.one(Dimension::kRoulette) < survival)) return false;
        path = {{surface.origin, s.direction}, flux / survival};
        return true;
    }

    const SceneData& scene_;
    std::uint64_t key_;
    std::vector<std::uint32_t> numbers_;
    std::vector<Ray> rays_;
    std::vector<V3f> fluxes_;
    std::vector<Hit> hits_;
};

std::vector<VirtualLight> sorted(const std::vector<VirtualLight>& lights) {
    std::vector<V3f> positions;
    positions.reserve(lights.size());
    for (const VirtualLight& light : lights) positions.push_back(light.position);
    std::vector<std::uint32_t> order(lights.size());
    std::iota(order.begin(), order.end(), 0u);
    std::vector<std::uint64_t> keys;
    sort_by_morton_code(positions, order, keys);
    std::vector<VirtualLight> result;
    result.reserve(lights.size());
    for (const std::uint32_t i : order) result.push_back(lights[i]);
    return result;
}

}  // namespace

std::vector<LightRay> emit(const EmissionTable& emission, std::uint32_t count, std::uint64_t key) {
    if (emission.empty()) return {};
    std::vector<LightRay> rays(count);
    for_each_block(count, kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            rays[i] = emission.sample({key, static_cast<std::uint32_t>(i), 0});
            rays[i].flux /= static_cast<float>(count);
        }
    });
    return rays;
}

void check_shadow_map_sources(const SceneData& scene) {
    for (const Emitter& emitter : scene.emitters) {
        if (std::holds_alternative<SpotEmitter>(emitter)) continue;
        if (std::holds_alternative<DirectionalEmitter>(emitter)) continue;
        throw Error(
            "reflective shadow map: only spots, directional lights and the environment can have "
            "one, and something else emits");
    }
}

std::vector<LightRay> shadow_map_rays(const SceneData& scene, const EmissionTable& emission,
                                      std::uint32_t edge, std::uint64_t key) {
    std::vector<LightRay> rays;
    const auto add_texels = [&](const auto& ray_of) {
        for (std::uint32_t texel = 0; texel < edge * edge; ++texel) {
            const PathRandom random(key, static_cast<std::uint32_t>(rays.size()), 0);
            const std::uint32_t x = texel % edge, y = texel / edge;
            const V2f corner(static_cast<float>(x), static_cast<float>(y));
            const V2f u = (corner + random.two(Dimension::kLightVertex)) / static_cast<float>(edge);
            rays.push_back(ray_of(random, u));
            rays.back().flux /= static_cast<float>(edge) * static_cast<float>(edge);
        }
    };
    for (const Emitter& emitter : scene.emitters) {
        if (const auto* sun = std::get_if<DirectionalEmitter>(&emitter)) {
            add_texels(
                [&](const PathRandom&, const V2f& u) { return emission.directional_ray(*sun, u); });
            continue;
        }
        const auto& spot = std::get<SpotEmitter>(emitter);
        add_texels([&](const PathRandom&, const V2f& u) { return spot_ray(spot, u); });
    }
    if (scene.environment) {
        add_texels([&](const PathRandom& random, const V2f& u) {
            return emission.environment_ray(random, u);
        });
    }
    return rays;
}

std::vector<VirtualLight> virtual_lights(const SceneData& scene,
                                         const std::vector<LightRay>& starts, std::uint32_t bounces,
                                         std::uint64_t key) {
    std::vector<std::vector<VirtualLight>> parts((starts.size() + kBlock - 1) / kBlock);
    for_each_block(starts.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        LightPaths paths(scene, starts.data() + begin, end - begin,
                         static_cast<std::uint32_t>(begin), key);
        for (std::uint32_t depth = 1; depth <= bounces; ++depth) {
            paths.advance(depth, parts[begin / kBlock]);
        }
    });
    std::vector<VirtualLight> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return sorted(all);
}

}  // namespace lightcull
