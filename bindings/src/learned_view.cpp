#include "learned_view.h"

#include <lightcull/sampler_info.h>
#include <lightcull/sets.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightcull::python {
namespace {

using PixelPoints = std::vector<std::optional<ShadingPoint>>;
using Points = std::vector<ShadingPoint>;

/// Pixels that the choice of a light goes by, and those for which lights are chosen.
constexpr std::size_t kPixels = 4096, kChoices = 256;

/// What `count` of the pixels show, or all if they are fewer, spread evenly.
Points seen(const PixelPoints& pixels, std::size_t count) {
    count = std::min(count, pixels.size());
    Points points;
    for (std::size_t i = 0; i < count; ++i) {
        const auto& pixel = pixels[i * pixels.size() / count];
        if (pixel) points.push_back(*pixel);
    }
    return points;
}

/// Lights that the sampler chooses at the points, ascending.
std::vector<std::uint32_t> chosen_lights(const LightSampler& sampler, Points points) {
    std::vector<std::uint32_t> lights;
    for (std::size_t i = 0; i < points.size(); ++i) {
        points[i].set = set_of_packet(static_cast<std::uint32_t>(i), sampler.set_count());
        const float u = std::fmod(0.618034f * static_cast<float>(i), 1.0f);  // golden ratio
        const Selection selection = sampler.select(points[i], u);
        if (selection.prob > 0.0f) lights.push_back(selection.light);
    }
    std::sort(lights.begin(), lights.end());
    lights.erase(std::unique(lights.begin(), lights.end()), lights.end());
    return lights;
}

/// The sum over the points of the squared difference of a light's visibility from its mean.
double variation(const SamplerInfo& info, const Points& points, std::uint32_t light) {
    double count = 0.0, sum = 0.0, squares = 0.0;
    for (const ShadingPoint& point : points) {
        const double v = double{info.learned_visibility(point, light)};
        if (std::isnan(v)) continue;
        count += 1.0;
        sum += v;
        squares += v * v;
    }
    return count > 0.0 ? squares - sum * sum / count : -1.0;
}

/// None if nothing is known of any light.
std::optional<std::uint32_t> most_telling_light(const LightSampler& sampler,
                                                const SamplerInfo& info,
                                                const PixelPoints& pixels) {
    const Points points = seen(pixels, kPixels);
    std::optional<std::uint32_t> best;
    double most = -1.0;
    for (const std::uint32_t light : chosen_lights(sampler, seen(pixels, kChoices))) {
        const double of_light = variation(info, points, light);
        if (of_light <= most) continue;
        best = light;
        most = of_light;
    }
    return best;
}

}  // namespace

std::optional<LearnedView> learned_view(const LightSampler& sampler, const Scene& scene,
                                        const RenderSettings& settings) {
    const SamplerInfo* const info = sampler_info(sampler);
    if (info == nullptr || info->cell_count() == 0) return {};
    const PixelPoints pixels = pixel_points(scene, settings);
    const auto light = most_telling_light(sampler, *info, pixels);
    if (!light) return {};
    const Light shown = scene.lights()[*light];
    LearnedView view{settings.width,
                     settings.height,
                     std::vector<std::int32_t>(pixels.size(), -1),
                     std::vector<float>(pixels.size(), std::numeric_limits<float>::quiet_NaN()),
                     std::vector<float3>(pixels.size(), float3{0, 0, 0}),
                     *light,
                     shown.directional ? std::nullopt : std::optional(shown.center),
                     info->cell_count(),
                     info->cell_memory_size()};
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (!pixels[i]) continue;
        view.cells[i] = static_cast<std::int32_t>(info->cell_of(*pixels[i]));
        view.visibility[i] = info->learned_visibility(*pixels[i], *light);
        view.normals[i] = pixels[i]->normal;
    }
    return view;
}

}  // namespace lightcull::python
