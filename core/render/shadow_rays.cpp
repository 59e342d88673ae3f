#include <lightcull/render/shadow_rays.h>

#include "render/checks.h"
#include "render/ray_tracer.h"
#include "render/scene_data.h"
#include "render/settings.h"
#include "render/tiles.h"

#include <lightcull/error.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace lightcull {
namespace {

/// The number of rays in a chunk: as many as the paths of a tile send at a time.
constexpr std::size_t kChunk = std::size_t{kTileSize} * kTileSize;

Ray shadow_ray(const ShadingPoint& point, const Light& light) {
    constexpr float kClearance = 1e-4f;  // part of the coordinates, and at least of a metre
    const V3f position = to_v3f(point.position);
    const float away = kClearance * std::max(1.0f, max_component(abs(position)));
    const V3f origin = position + to_v3f(point.normal) * away;
    return light.directional ? Ray{origin, -to_v3f(light.axis)}
                             : segment(origin, to_v3f(light.center));
}

void check_selections(Span<const ShadingPoint> points, Span<const Selection> selections,
                      std::size_t light_count) {
    if (selections.size() != points.size()) {
        throw Error("shadow rays: there are " + std::to_string(selections.size()) +
                    " selections for " + std::to_string(points.size()) + " points");
    }
    for (std::size_t i = 0; i < selections.size(); ++i) {
        if (!(selections[i].prob > 0.0f) || selections[i].light < light_count) continue;
        check::index("shadow rays: " + check::element("selections", i) + ": light",
                     selections[i].light, light_count, "lights");
    }
}

}  // namespace

struct ShadowRays::Impl {
    const RayTracer& tracer;
    std::vector<Ray> rays;
};

ShadowRays::ShadowRays(const Scene& scene, Span<const ShadingPoint> points,
                       Span<const Selection> selections) {
    check_committed(scene);
    check_selections(points, selections, scene.lights().size());
    impl_ = std::make_unique<Impl>(Impl{*data_of(scene).ray_tracer, {}});
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!(selections[i].prob > 0.0f)) continue;
        impl_->rays.push_back(shadow_ray(points[i], scene.lights()[selections[i].light]));
    }
}

ShadowRays::~ShadowRays() = default;

std::size_t ShadowRays::size() const noexcept {
    return impl_->rays.size();
}

std::size_t ShadowRays::trace(Span<std::uint8_t> arrived) const {
    const Span<const Ray> rays(impl_->rays);
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, rays.size(), kChunk), std::size_t{0},
        [&](const tbb::blocked_range<std::size_t>& range, std::size_t reached) {
            std::vector<std::uint8_t> occluded(range.size());
            impl_->tracer.occluded({rays.data() + range.begin(), range.size()}, occluded);
            for (std::size_t i = 0; !arrived.empty() && i < range.size(); ++i) {
                arrived[range.begin() + i] = occluded[i] == 0 ? 1 : 0;
            }
            return reached + static_cast<std::size_t>(
                                 std::count(occluded.begin(), occluded.end(), std::uint8_t{0}));
        },
        std::plus<>());
}

}  // namespace lightcull
