#include "render/camera.h"
#include "render/camera_hits.h"
#include "render/path_random.h"
#include "render/scene_data.h"
#include "render/settings.h"
#include "render/surface.h"

#include <lightcull/render/renderer.h>
#include <lightcull/samplers.h>

#include <algorithm>
#include <cmath>

namespace lightcull {
namespace {

/// The number of points of each kind that a sampler is calibrated on.
constexpr std::uint32_t kCalibrationPoints = 128;

/// The surfaces where rays hit something.
std::vector<Surface> surfaces_at(const SceneData& scene, const std::vector<Ray>& rays,
                                 const std::vector<Hit>& hits) {
    std::vector<Surface> surfaces;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].triangle == kNoHit) continue;
        surfaces.push_back(make_surface(scene, hits[i], rays[i].direction));
    }
    return surfaces;
}

/// Rays through the centres of about `count` cells, in which the image is divided, row by row.
std::vector<Ray> camera_rays(const Scene& scene, const RenderSettings& settings,
                             std::uint32_t count) {
    check_committed(scene);
    check_settings(settings);
    const auto width = static_cast<float>(settings.width);
    const auto height = static_cast<float>(settings.height);
    const float cell = std::sqrt(width * height / static_cast<float>(std::max(count, 1u)));
    const auto cells = [&](std::uint32_t pixels) {
        const float wanted = std::round(static_cast<float>(pixels) / cell);
        return std::clamp(static_cast<std::uint32_t>(wanted), 1u, pixels);
    };
    const V2f grid(static_cast<float>(cells(settings.width)),
                   static_cast<float>(cells(settings.height)));
    const CameraRays camera(scene.camera(), settings.width, settings.height);
    std::vector<Ray> rays;
    for (std::uint32_t y = 0; y < cells(settings.height); ++y) {
        for (std::uint32_t x = 0; x < cells(settings.width); ++x) {
            const V2f place(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
            rays.push_back(camera.ray(place / grid * V2f(width, height), V2f(0.5f)));
        }
    }
    return rays;
}

/// The surfaces that these rays meet.
std::vector<Surface> camera_surfaces(const Scene& scene, const RenderSettings& settings,
                                     std::uint32_t count) {
    std::vector<Ray> rays = camera_rays(scene, settings, count);
    std::vector<Hit> hits(rays.size());
    intersect_camera_rays(data_of(scene), settings.hide_emitters, rays, hits);
    return surfaces_at(data_of(scene), rays, hits);
}

/// The surfaces that one scattered ray from each of the surfaces meets.
std::vector<Surface> bounce(const SceneData& scene, const std::vector<Surface>& from) {
    std::vector<Ray> rays;
    for (std::uint32_t i = 0; i < from.size(); ++i) {
        const PathRandom random(0, i, 1);
        const BsdfSample s =
            from[i].bsdf.sample(random.one(Dimension::kLobe), random.two(Dimension::kScatter));
        if (s.pdf > 0.0f && s.direction.dot(from[i].normal) > 0.0f) {
            rays.push_back({from[i].origin, s.direction});
        }
    }
    std::vector<Hit> hits(rays.size());
    scene.ray_tracer->intersect(rays, hits, false);
    return surfaces_at(scene, rays, hits);
}

void append(const std::vector<Surface>& surfaces, std::vector<ShadingPoint>& points) {
    for (const Surface& s : surfaces) points.push_back(s.shading_point(0));
}

}  // namespace

std::vector<ShadingPoint> camera_points(const Scene& scene, const RenderSettings& settings,
                                        std::uint32_t count) {
    std::vector<ShadingPoint> points;
    append(camera_surfaces(scene, settings, count), points);
    return points;
}

std::vector<std::optional<ShadingPoint>> pixel_points(const Scene& scene,
                                                      const RenderSettings& settings) {
    std::vector<Ray> rays = camera_rays(scene, settings, settings.width * settings.height);
    const SceneData& data = data_of(scene);
    std::vector<Hit> hits(rays.size());
    intersect_camera_rays(data, settings.hide_emitters, rays, hits);
    std::vector<std::optional<ShadingPoint>> points(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].triangle == kNoHit) continue;
        points[i] = make_surface(data, hits[i], rays[i].direction).shading_point(0);
    }
    return points;
}

std::unique_ptr<LightSampler> make_scene_sampler(std::string_view description, const Scene& scene,
                                                 const RenderSettings& settings) {
    const std::vector<Surface> seen = camera_surfaces(scene, settings, kCalibrationPoints);
    std::vector<ShadingPoint> points;
    append(seen, points);
    if (settings.max_depth > 2) append(bounce(data_of(scene), seen), points);
    return make_sampler(description, scene.lights(), {points, settings.width * settings.height});
}

}  // namespace lightcull
