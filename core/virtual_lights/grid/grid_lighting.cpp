#include "virtual_lights/grid/grid_lighting.h"

#include "base/random.h"
#include "base/reservoir.h"
#include "render/tiles.h"
#include "virtual_lights/view/a_trous.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace lightcull {
namespace {

/// The mark of a pixel without light: filter_a_trous() takes it for no number.
constexpr float kNoLight = -1.0f;

/// Lights the pixels of a tile.
class GridTile {
  public:
    GridTile(const LightingPass& pass, const std::vector<VirtualLight>& lights,
             const GridHierarchy& hierarchy, const GridFinder& finder, float nearest2)
        : pass_(pass),
          lights_(lights),
          hierarchy_(hierarchy),
          finder_(finder),
          nearest2_(nearest2) {}

    /// Lights the tile. light: without shadows; visible: the part of it that shadow samples reach.
    LightingCounts run(const Tile& tile, std::vector<V3f>& light, std::vector<float>& visible) {
        for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
            for (std::uint32_t x = tile.x0; x < tile.x1; ++x) {
                const std::size_t pixel = pass_.view.index(x, y);
                if (pass_.view.hit[pixel] == 0) continue;
                start_samples(pixel);
                light[pixel] = sum(pass_.view.surfaces[pixel]);
                if (!samples_.empty()) visible[pixel] = visibility(pixel);
            }
        }
        return counts_;
    }

  private:
    void start_samples(std::size_t pixel) {
        samples_.clear();
        if (pass_.options.shadows == VirtualShadows::kNone) return;
        RandomStream random(hash(pass_.key, pixel));
        for (std::uint32_t k = 0; k < pass_.options.shadow_samples; ++k) {
            samples_.emplace_back(random.next());
        }
    }

    V3f sum(const Surface& surface) {
        V3f total(0.0f);
        const Receiver receiver(to_float3(surface.position), to_float3(surface.normal));
        finder_.for_each(receiver, [&](std::uint32_t number, GridFinder::Found found) {
            ++counts_.listed;
            const V3f value = contribution(surface, found);
            const float weight = luminance(value);
            if (!(weight > 0.0f)) return;
            ++counts_.accepted;
            total += value;
            for (Reservoir& sample : samples_) sample.add(number, weight, weight);
        });
        return total;
    }

    V3f contribution(const Surface& surface, GridFinder::Found found) const noexcept {
        const V3f way = position(found) - surface.position;
        const float distance2 = way.dot(way), distance = std::sqrt(distance2);
        if (!(distance2 > 0.0f)) return V3f(0.0f);
        const float share = hierarchy_.blend(found.level, distance);
        const V3f direction = way / distance;
        if (!(share > 0.0f) || surface.normal.dot(direction) <= 0.0f) return V3f(0.0f);
        const V3f sent = found.level == 0
                             ? intensity(lights_[found.index], -direction)
                             : intensity(hierarchy_.level(found.level)[found.index], -direction);
        return surface.bsdf.evaluate(direction).value * sent *
               (share / std::max(distance2, nearest2_));
    }

    const V3f& position(GridFinder::Found found) const noexcept {
        return found.level == 0 ? lights_[found.index].position
                                : hierarchy_.level(found.level)[found.index].position;
    }

    /// The mean over the shadow samples, or kNoLight.
    float visibility(std::size_t pixel) {
        const Surface& surface = pass_.view.surfaces[pixel];
        RandomStream random(hash(pass_.key, pixel, std::uint64_t{1}));
        rays_.clear();
        for (const Reservoir& sample : samples_) {
            if (!sample.chosen()) return kNoLight;
            rays_.push_back(shadow_ray(surface.origin, finder_[sample.light()], random));
        }
        occluded_.resize(rays_.size());
        pass_.tracer.occluded(rays_, occluded_);
        counts_.shadow_rays += rays_.size();
        const auto open = std::count(occluded_.begin(), occluded_.end(), std::uint8_t{0});
        return static_cast<float>(open) / static_cast<float>(rays_.size());
    }

    /// A shadow ray to a place drawn uniformly from a box with the deviation of the lights that the
    /// grid light stands for. They lie on surfaces, and half of the box behind those: a ray to the
    /// place would meet the very surfaces that shine (in a closed room two fifths of the light were
    /// lost so), so it ends where the box may begin.
    Ray shadow_ray(const V3f& origin, GridFinder::Found found,
                   RandomStream& random) const noexcept {
        if (found.level == 0) return segment(origin, position(found));
        const float x = random.next(), y = random.next(), z = random.next();
        const V3f box = hierarchy_.level(found.level)[found.index].deviation * std::sqrt(3.0f);
        const V3f to_place =
            position(found) - origin + box * V3f(2.0f * x - 1.0f, 2.0f * y - 1.0f, 2.0f * z - 1.0f);
        const float end = 1.0f - box.length() / to_place.length();
        return {origin, to_place, std::max(end, 0.0f)};
    }

    const LightingPass& pass_;
    const std::vector<VirtualLight>& lights_;
    const GridHierarchy& hierarchy_;
    const GridFinder& finder_;
    float nearest2_;
    LightingCounts counts_;
    std::vector<Reservoir> samples_;
    std::vector<Ray> rays_;
    std::vector<std::uint8_t> occluded_;
};

/// Makes RandomRanges in which a light's range is the root of its intensity.
RandomRanges ranges_of_intensity() {
    return {1.0f, 1, RangeLaw::kConstant};
}

}  // namespace

GridFinder::GridFinder(const std::vector<VirtualLight>& lights, const GridHierarchy& hierarchy) {
    std::vector<RangedLight> ranged;
    const auto add = [&](std::uint32_t level, const auto& of_level) {
        const float range = 2.0f * hierarchy.radius(level);
        for (std::uint32_t i = 0; i < of_level.size(); ++i) {
            found_.push_back({level, i});
            if (level == hierarchy.level_count()) continue;
            ranged.push_back({to_float3(of_level[i].position), 0.0f, range * range});
        }
    };
    add(0, lights);
    for (std::uint32_t l = 1; l <= hierarchy.level_count(); ++l) add(l, hierarchy.level(l));
    first_unlimited_ = static_cast<std::uint32_t>(ranged.size());
    tree_.emplace(ranged, ranges_of_intensity());
    tree_->begin_pass(0);
}

LightingCounts add_grid_lighting(const LightingPass& pass, const std::vector<VirtualLight>& lights,
                                 const GridHierarchy& hierarchy, Span<V3f> pixels) {
    const GridFinder finder(lights, hierarchy);
    const float nearest2 = nearest_distance2(lights);
    std::vector<V3f> light(pixels.size(), V3f(0.0f));
    std::vector<float> visible(pixels.size(), kNoLight);
    const std::vector<Tile> tiles = tiles_of({0, 0, pass.view.width, pass.view.height}, kTileSize);
    std::vector<LightingCounts> counts(tiles.size());
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
        if (pass.cancelled()) return;
        counts[i] =
            GridTile(pass, lights, hierarchy, finder, nearest2).run(tiles[i], light, visible);
    });
    const bool shadows = pass.options.shadows != VirtualShadows::kNone;
    if (shadows && pass.options.filter && !pass.cancelled()) filter_a_trous(pass.view, visible);
    for (std::size_t i = 0; i < light.size(); ++i) {
        pixels[i] += shadows ? light[i] * std::max(visible[i], 0.0f) : light[i];
    }
    LightingCounts sum;
    for (const LightingCounts& c : counts) sum += c;
    return sum;
}

}  // namespace lightcull
