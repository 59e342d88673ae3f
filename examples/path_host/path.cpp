#include "path.h"

#include <algorithm>

namespace host {

using lightcull::LightSelector;
using lightcull::Selection;
using lightcull::ShadingPoint;

namespace {

constexpr std::uint32_t kMaxBounces = 4;  ///< surfaces on a path
constexpr float kOffset = 1e-3f;  ///< distance that keeps rays off the surfaces at their ends

/// The balance heuristic.
float mis_weight(float pdf, float other_pdf) {
    return pdf / (pdf + other_pdf);
}

float sky_pdf(float3 normal, float3 direction) {
    return std::max(dot(normal, direction), 0.0f) / kPi;
}

}  // namespace

Path start(const Scene& scene, const Job& job, std::uint32_t pixel, std::uint32_t sample) {
    Path path;
    // The random numbers go by pixel and sample, whatever thread comes upon them.
    path.random = Random(mix(mix(job.seed) + pixel) + sample);
    const auto width = static_cast<float>(job.width), height = static_cast<float>(job.height);
    const std::uint32_t column = pixel % job.width, row = pixel / job.width;
    const float x = static_cast<float>(column) + path.random.uniform();
    const float y = static_cast<float>(row) + path.random.uniform();
    path.ray = scene.camera_ray((2.0f * x - width) / height, (height - 2.0f * y) / height);
    return path;
}

bool arrive(const Scene& scene, const LightSelector& selector, std::uint32_t bounce, Path& path) {
    const float3 direction = path.ray.direction;
    const Hit hit = scene.intersect(path.ray);
    if (hit.distance == INFINITY) {
        float weight = 1.0f;
        if (!path.from_camera) {
            weight = mis_weight(path.bsdf_pdf, sky_pdf(path.left.normal, direction));
        }
        path.radiance = path.radiance + weight * path.weight * scene.sky(direction);
        return false;
    }
    if (hit.emitter != Hit::kNoEmitter) {
        const Emitter& emitter = scene.emitters()[hit.emitter];
        const float area_cosine = -dot(emitter.normal_times_area(), direction);
        if (area_cosine <= 0.0f) return false;  // the emitter's back
        float weight = 1.0f;
        if (!path.from_camera) {
            // How likely would light sampling have come here? lightcull knows with what probability
            // it would have chosen this light at the point that the ray left. So it is asked with
            // that point's receipt, not with anything of this one. The density of the vertex on the
            // light, by solid angle, is ours.
            const float pdf = selector.prob(path.left, path.receipt, hit.emitter) * hit.distance *
                              hit.distance / area_cosine;
            weight = mis_weight(path.bsdf_pdf, pdf);
        }
        path.radiance = path.radiance + weight * path.weight * emitter.radiance;
        return false;
    }
    path.surface = Surface(hit.material, hit.normal, -1.0f * direction);
    path.position = path.ray.origin + hit.distance * direction + kOffset * hit.normal;
    return bounce < kMaxBounces;
}

ShadingPoint shading_point(const Path& path, std::uint32_t set) {
    const Surface& surface = path.surface;
    ShadingPoint point;
    point.position = path.position;
    point.normal = surface.normal();
    point.set = set;
    point.diffuse = luminance(surface.material().albedo) / kPi;
    point.lobe.axis = surface.mirror_direction();
    point.lobe.alpha = surface.material().alpha;
    // F D / 4 over the cosine of the view.
    point.lobe.peak = luminance(surface.fresnel(surface.cos_view())) * surface.ggx(1.0f) /
                      (4.0f * surface.cos_view());
    return point;
}

std::optional<float> add_light(const Scene& scene, const Selection& selection, Path& path) {
    const Surface& surface = path.surface;
    std::optional<float> visibility;
    // prob is 0 where no light was chosen. That is no error: it is a sample that brings nothing.
    if (selection.prob > 0.0f) {
        const Emitter& emitter = scene.emitters()[selection.light];
        // select() has used up its random number: a vertex takes fresh ones.
        const float3 to_vertex = emitter.point(path.random) - path.position;
        const float distance = std::sqrt(dot(to_vertex, to_vertex));
        const float3 direction = (1.0f / distance) * to_vertex;
        const float area_cosine = -dot(emitter.normal_times_area(), direction);
        const float3 bsdf = surface.bsdf_cosine(direction);
        if (area_cosine > 0.0f && luminance(bsdf) > 0.0f) {
            const bool is_free = scene.is_free({path.position, direction}, distance - kOffset);
            visibility = is_free ? 1.0f : 0.0f;
        }
        if (visibility == 1.0f) {
            const float vertex_pdf = distance * distance / area_cosine;  // by solid angle
            // We divide by prob, and weigh by mis_prob. For most samplers they are the same.
            const float weight =
                mis_weight(selection.mis_prob * vertex_pdf, surface.pdf(direction));
            const float scale = weight / (selection.prob * vertex_pdf);
            path.radiance = path.radiance + scale * path.weight * bsdf * emitter.radiance;
        }
    }
    // lightcull chooses among lights that have a place. The sky has none, so it gets a sample of
    // its own.
    const float3 direction = Frame(surface.normal()).to_world(cosine_direction(path.random));
    const float pdf = sky_pdf(surface.normal(), direction);
    if (pdf > 0.0f && scene.is_free({path.position, direction}, INFINITY)) {
        const float scale = mis_weight(pdf, surface.pdf(direction)) / pdf;
        path.radiance = path.radiance +
                        scale * path.weight * surface.bsdf_cosine(direction) * scene.sky(direction);
    }
    return visibility;
}

bool leave(const ShadingPoint& point, const Selection& selection, Path& path) {
    const float3 direction = path.surface.sample(path.random);
    const float pdf = path.surface.pdf(direction);
    if (!(pdf > 0.0f)) return false;
    path.weight = (1.0f / pdf) * path.weight * path.surface.bsdf_cosine(direction);
    path.ray = {path.position, direction};
    path.from_camera = false;
    path.left = point;
    path.receipt = selection.receipt;  // valid also where no light was chosen
    path.bsdf_pdf = pdf;
    return luminance(path.weight) > 0.0f;
}

}  // namespace host
