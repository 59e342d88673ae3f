#include "virtual_lights/tiled_lighting.h"

#include "base/random.h"
#include "lights/parallel_blocks.h"
#include "virtual_lights/imperfect_shadow_maps.h"
#include "virtual_lights/tile_bounds.h"

#include <lightcull/error.h>

#include <ImathBox.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>

namespace lightcull {
namespace {

/// Edge of a tile, in pixels of a sub-image.
constexpr std::uint32_t kTileEdge = 16;

/// Pixels of one tile of a sub-image: every `step`-th of every `step`-th row.
struct SubTile {
    std::uint32_t x0, y0, step;

    template <typename Visit>
    void for_each_pixel(const CameraView& view, Visit&& visit) const {
        for (std::uint32_t j = 0, y = y0; j < kTileEdge && y < view.height; ++j, y += step) {
            for (std::uint32_t i = 0, x = x0; i < kTileEdge && x < view.width; ++i, x += step) {
                const std::size_t pixel = view.index(x, y);
                if (view.hit[pixel] != 0) visit(pixel);
            }
        }
    }
};

std::vector<SubTile> sub_tiles(const CameraView& view, std::uint32_t step) {
    std::vector<SubTile> tiles;
    const std::uint32_t extent = kTileEdge * step;
    for (std::uint32_t y = 0; y < view.height; y += extent) {
        for (std::uint32_t x = 0; x < view.width; x += extent) {
            for (std::uint32_t i = 0; i < step * step; ++i) {
                tiles.push_back({x + i % step, y + i / step, step});
            }
        }
    }
    return tiles;
}

/// The lights of a pass, and what of them does not depend on the pixel. Those of a subset, every
/// count-th, lie together.
class PreparedLights {
  public:
    PreparedLights(const LightingPass& pass, const std::vector<VirtualLight>& lights,
                   const Acceptance& acceptance, std::uint32_t subsets)
        : subsets_(subsets), begins_{0} {
        for (std::uint32_t s = 0; s < subsets; ++s) {
            for (std::size_t i = s; i < lights.size(); i += subsets) lights_.push_back(lights[i]);
            begins_.push_back(lights_.size());
        }
        of_light_.resize(lights_.size());
        const bool culled = pass.options.method != VirtualLightMethod::kAll;
        if (culled) volumes_.resize(lights_.size());
        constexpr std::size_t kBlock = 4096;
        for_each_block(lights_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                of_light_[i] = acceptance.of_light(lights_[i], static_cast<std::uint32_t>(i));
                if (!culled) continue;
                const Spheroid volume =
                    acceptance.volume(lights_[i], of_light_[i], pass.options.volume);
                volumes_[i] = VolumeInView(volume, pass.camera);
            }
        });
    }

    std::uint32_t subsets() const noexcept { return subsets_; }
    const VirtualLight& light(std::size_t i) const noexcept { return lights_[i]; }
    const Acceptance::OfLight& of_light(std::size_t i) const noexcept { return of_light_[i]; }

    const std::vector<VirtualLight>& all() const noexcept { return lights_; }

    /// The lights of a subset that may count somewhere in a piece of a tile.
    void list(std::uint32_t subset, const FrustumPiece& piece,
              std::vector<std::uint32_t>& list) const {
        list.clear();
        if (piece.empty) return;
        for (std::size_t i = begins_[subset]; i < begins_[subset + 1]; ++i) {
            if (volumes_.empty() || volumes_[i].overlaps(piece)) {
                list.push_back(static_cast<std::uint32_t>(i));
            }
        }
    }

  private:
    std::uint32_t subsets_;
    std::vector<std::size_t> begins_;
    std::vector<VirtualLight> lights_;
    std::vector<Acceptance::OfLight> of_light_;
    std::vector<VolumeInView> volumes_;
};

/// Lights the pixels of a tile.
class TileLighting {
  public:
    TileLighting(const LightingPass& pass, const PreparedLights& lights,
                 const Acceptance& acceptance, const ImperfectShadowMaps* maps, float nearest2,
                 Span<V3f> pixels)
        : pass_(pass),
          lights_(lights),
          acceptance_(acceptance),
          maps_(maps),
          nearest2_(nearest2),
          scale_(static_cast<float>(lights.subsets())),
          pixels_(pixels) {}

    LightingCounts run(const SubTile& tile) {
        std::vector<V3f> points;
        tile.for_each_pixel(pass_.view,
                            [&](std::size_t i) { points.push_back(pass_.view.view_positions[i]); });
        const TileBounds bounds{Span<const V3f>(points)};
        for (std::uint32_t c = 0; c < TileBounds::kClusters; ++c) {
            lights_.list(subset_of(tile), bounds.piece(c), lists_[c]);
        }
        tile.for_each_pixel(pass_.view, [&](std::size_t i) {
            const auto& list = lists_[bounds.cluster_of(pass_.view.view_positions[i])];
            counts_.listed += list.size();
            for (const std::uint32_t light : list) add(i, light);
            trace_shadows(i);
        });
        return counts_;
    }

  private:
    /// Each pixel of a square has a subset of its own, another one in each pass.
    std::uint32_t subset_of(const SubTile& tile) const noexcept {
        const std::uint32_t subsets = lights_.subsets();
        const auto turn = static_cast<std::uint32_t>(hash(pass_.key, 0x7375627365740) % subsets);
        return (set_of_pixel(tile.x0, tile.y0, subsets) + turn) % subsets;
    }

    void add(std::size_t pixel, std::uint32_t index) {
        const VirtualLight& light = lights_.light(index);
        const Surface& surface = pass_.view.surfaces[pixel];
        const V3f way = light.position - surface.position;
        const float distance2 = way.dot(way);
        if (!(distance2 > 0.0f)) return;
        const float distance = std::sqrt(distance2);
        const V3f direction = way / distance;
        const V3f sent = intensity(light, -direction);
        const float strength = luminance(sent);
        if (!(strength > 0.0f)) return;
        const float weight = acceptance_.weight(lights_.of_light(index), strength, distance);
        if (!(weight > 0.0f)) return;
        ++counts_.accepted;
        if (surface.normal.dot(direction) <= 0.0f) return;
        const V3f value = surface.bsdf.evaluate(direction).value * sent *
                          (scale_ * weight / std::max(distance2, nearest2_));
        if (value == V3f(0.0f)) return;
        if (pass_.options.shadows != VirtualShadows::kRays) {
            const bool is_dark =
                maps_ != nullptr && maps_->occluded(index, light, surface.position);
            if (!is_dark) pixels_[pixel] += value;
            return;
        }
        rays_.push_back({surface.origin, light.position - surface.origin, kShadowEnd});
        values_.push_back(value);
    }

    void trace_shadows(std::size_t pixel) {
        occluded_.resize(rays_.size());
        pass_.tracer.occluded(rays_, occluded_);
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            if (occluded_[i] == 0) pixels_[pixel] += values_[i];
        }
        counts_.shadow_rays += rays_.size();
        rays_.clear();
        values_.clear();
    }

    const LightingPass& pass_;
    const PreparedLights& lights_;
    const Acceptance& acceptance_;
    const ImperfectShadowMaps* maps_;  // null without
    float nearest2_, scale_;
    Span<V3f> pixels_;
    LightingCounts counts_;
    std::array<std::vector<std::uint32_t>, TileBounds::kClusters> lists_;
    std::vector<Ray> rays_;
    std::vector<V3f> values_;
    std::vector<std::uint8_t> occluded_;
};

ImperfectShadowMaps make_maps(const LightingPass& pass, const PreparedLights& lights,
                              const Acceptance& acceptance) {
    const std::vector<VirtualLight>& all = lights.all();
    if (all.size() > ImperfectShadowMaps::kMostLights) {
        throw Error("virtual lights: " + std::to_string(all.size()) +
                    " are too many for shadows=maps: at most " +
                    std::to_string(ImperfectShadowMaps::kMostLights));
    }
    std::vector<float> ranges(all.size(), std::numeric_limits<float>::infinity());
    if (pass.options.method != VirtualLightMethod::kAll && pass.options.map_culling) {
        for (std::size_t i = 0; i < all.size(); ++i) {
            const BoundingVolume kind = BoundingVolume::kSphereAtLight;
            ranges[i] = acceptance.volume(all[i], lights.of_light(i), kind).radius;
        }
    }
    return {all, ranges, pass.cloud, pass.options.map_points, pass.key};
}

}  // namespace

float nearest_distance2(const std::vector<VirtualLight>& lights) noexcept {
    Imath::Box3f box;
    for (const VirtualLight& light : lights) box.extendBy(light.position);
    if (box.isEmpty()) return 0.0f;
    const V3f size = box.size();
    return size.dot(size) / static_cast<float>(lights.size());
}

LightingCounts add_tiled_lighting(const LightingPass& pass, const std::vector<VirtualLight>& lights,
                                  const Acceptance& acceptance, Span<V3f> pixels) {
    const std::uint32_t edge = pass.options.interleave;
    const PreparedLights prepared(pass, lights, acceptance, edge * edge);
    const float nearest2 = nearest_distance2(lights);
    const std::vector<SubTile> tiles = sub_tiles(pass.view, edge);
    LightingCounts sum;
    std::optional<ImperfectShadowMaps> maps;
    if (pass.options.shadows == VirtualShadows::kMaps) {
        const auto start = std::chrono::steady_clock::now();
        maps.emplace(make_maps(pass, prepared, acceptance));
        sum.map_points = maps->splatted();
        sum.build_seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    std::vector<LightingCounts> counts(tiles.size());
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
        if (pass.cancelled()) return;
        TileLighting tile(pass, prepared, acceptance, maps ? &*maps : nullptr, nearest2, pixels);
        counts[i] = tile.run(tiles[i]);
    });
    for (const LightingCounts& c : counts) sum += c;
    return sum;
}

}  // namespace lightcull
