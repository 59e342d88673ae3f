#include "render/wavefront.h"

#include "render/camera_hits.h"
#include "render/emitter.h"
#include "render/morton_sort.h"
#include "render/scene_data.h"

#include <lightcull/sets.h>

#include <algorithm>
#include <utility>
#include <variant>

namespace lightcull {
namespace {

/// Camera rays are traced in packets of a square of this many pixels.
constexpr std::uint32_t kBlock = 4;

}  // namespace

void Wavefront::start(const Pass& pass, const Tile& tile) {
    pass_ = &pass;
    paths_.clear();
    rays_.clear();
    depth_ = 0;
    for (std::uint32_t y0 = tile.y0; y0 < tile.y1; y0 += kBlock) {
        for (std::uint32_t x0 = tile.x0; x0 < tile.x1; x0 += kBlock) {
            if (pass.one_in > 1 && hash(pass.key, x0, y0) % pass.one_in != 0) continue;
            for (std::uint32_t y = y0; y < std::min(y0 + kBlock, tile.y1); ++y) {
                for (std::uint32_t x = x0; x < std::min(x0 + kBlock, tile.x1); ++x) {
                    const std::uint32_t pixel = y * pass_->settings.width + x;
                    paths_.push_back({pixel, V3f(1.0f), 0.0f, {}, {}});
                    rays_.push_back(pass_->camera_rays.ray(pixel));
                }
            }
        }
    }
}

bool Wavefront::advance() {
    if (rays_.empty() || pass_->cancelled()) return false;
    ++depth_;
    numbers_ = {pass_->numbers_key, pass_->number, depth_};
    intersect();
    add_emission();
    if (depth_ == pass_->settings.max_depth) return false;
    if (depth_ > 1) sort_along_curve();
    make_vertices();
    return !order_.empty();
}

void Wavefront::shade() {
    const RenderSettings& settings = pass_->settings;
    if (settings.direct_light != DirectLight::kBsdf) add_direct_light();
    const bool next_is_last = depth_ + 1 == settings.max_depth;
    if (next_is_last && settings.direct_light == DirectLight::kLights) {
        rays_.clear();
    } else {
        scatter();
    }
}

std::uint64_t Wavefront::take_ray_count() noexcept {
    return std::exchange(rays_traced_, 0);
}

void Wavefront::intersect() {
    hits_.resize(rays_.size());
    if (depth_ == 1) {
        rays_traced_ +=
            intersect_camera_rays(pass_->scene, pass_->settings.hide_emitters, rays_, hits_);
    } else {
        pass_->scene.ray_tracer->intersect(rays_, hits_, false);
        rays_traced_ += rays_.size();
    }
}

void Wavefront::add_emission() {
    V3f* const seen = depth_ == 1 ? pass_->emission : nullptr;
    const auto add = [&](std::uint32_t pixel, const V3f& light) {
        pass_->pixels[pixel] += light;
        if (seen != nullptr) seen[pixel] += light;
    };
    order_.clear();
    for (std::uint32_t i = 0; i < rays_.size(); ++i) {
        const Path& path = paths_[i];
        if (hits_[i].triangle == kNoHit) {
            add(path.pixel, path.throughput * escaped(path, rays_[i]));
            continue;
        }
        const std::uint32_t light = pass_->scene.triangles[hits_[i].triangle].light;
        if (light != kNone) {
            add(path.pixel, path.throughput * emitted_by(light, path, rays_[i], hits_[i]));
        }
        order_.push_back(i);
    }
}

V3f Wavefront::escaped(const Path& path, const Ray& ray) const noexcept {
    const bool is_hidden = depth_ == 1 && pass_->settings.hide_emitters;
    if (!pass_->scene.environment || is_hidden) return V3f(0.0f);
    const EnvironmentValue value = pass_->scene.environment->at(ray.direction);
    return value.radiance * hit_weight(path, value.pdf);
}

V3f Wavefront::emitted_by(std::uint32_t light, const Path& path, const Ray& ray,
                          const Hit& hit) const noexcept {
    const auto& emitter = *std::get_if<TriangleEmitter>(&pass_->scene.emitters[light]);
    const V3f radiance = emitted(pass_->scene, emitter, hit.u, hit.v, -ray.direction);
    if (radiance == V3f(0.0f)) return radiance;
    float pdf = 0.0f;
    if (depth_ > 1 && pass_->settings.direct_light == DirectLight::kMis) {
        const V3f from = to_v3f(path.point.position);
        const PlacePdf of_place = place_pdf(pass_->scene, light, {hit.u, hit.v}, from,
                                            hit_position(pass_->scene, hit) - from);
        pdf = pass_->sampler.prob(path.point, path.receipt, of_place.light) * of_place.pdf;
    }
    return radiance * hit_weight(path, pdf);
}

/// The MIS weight of light that a ray has found, `light_pdf` being the density with which light
/// sampling would have chosen its direction.
float Wavefront::hit_weight(const Path& path, float light_pdf) const noexcept {
    if (depth_ == 1) return 1.0f;
    switch (pass_->settings.direct_light) {
        case DirectLight::kLights:
            return 0.0f;
        case DirectLight::kBsdf:
            return 1.0f;
        case DirectLight::kMis:
            break;
    }
    return path.bsdf_pdf / (path.bsdf_pdf + light_pdf);
}

void Wavefront::sort_along_curve() {
    positions_.clear();
    for (const std::uint32_t i : order_) {
        positions_.push_back(hit_position(pass_->scene, hits_[i]));
    }
    sort_by_morton_code(positions_, order_, sort_keys_);
}

void Wavefront::make_vertices() {
    surfaces_.clear();
    points_.clear();
    selection_u_.clear();
    for (std::size_t k = 0; k < order_.size(); ++k) {
        const std::uint32_t i = order_[k];
        surfaces_.push_back(make_surface(pass_->scene, hits_[i], rays_[i].direction));
        if (!needs_selection()) continue;
        points_.push_back(surfaces_.back().shading_point(set_of(k)));
        selection_u_.push_back(numbers_of(path_of(k).pixel).select_light());
    }
    selections_.assign(order_.size(), Selection{});
}

std::uint32_t Wavefront::set_of(std::size_t vertex) const noexcept {
    const std::uint32_t sets = pass_->sampler.set_count();
    if (depth_ > 1) {
        return set_of_packet(static_cast<std::uint32_t>(vertex / kPointsPerPacket), sets);
    }
    const std::uint32_t pixel = path_of(vertex).pixel, width = pass_->settings.width;
    return set_of_pixel(pixel % width, pixel / width, pass_->key, sets);
}

bool Wavefront::needs_selection() const noexcept {
    return has_lights() && pass_->settings.direct_light != DirectLight::kBsdf;
}

bool Wavefront::has_lights() const noexcept {
    return !pass_->scene.lights.empty();
}

void Wavefront::add_direct_light() {
    if (!has_lights() && !pass_->scene.environment) return;
    shadow_rays_.clear();
    contributions_.clear();
    for (std::size_t k = 0; k < order_.size(); ++k) {
        const std::uint32_t pixel = path_of(k).pixel;
        const PixelNumbers numbers = numbers_of(pixel);
        const auto shoot = [&](const LightSample& sample, std::uint32_t vertex) {
            if (sample.value == V3f(0.0f)) return;
            shadow_rays_.push_back(sample.shadow_ray);
            contributions_.push_back({pixel, vertex, sample.value});
        };
        // The light and the environment get one ray each: a choice between the two would double the
        // variance of both.
        if (has_lights()) shoot(sample_light(k, numbers), static_cast<std::uint32_t>(k));
        if (pass_->scene.environment) shoot(sample_environment(k, numbers), kNone);
    }
    occluded_.resize(shadow_rays_.size());
    pass_->scene.ray_tracer->occluded(shadow_rays_, occluded_);
    rays_traced_ += shadow_rays_.size();
    for (std::size_t j = 0; j < shadow_rays_.size(); ++j) {
        if (occluded_[j] == 0) pass_->pixels[contributions_[j].pixel] += contributions_[j].value;
    }
    if (pass_->reports) report_visibility();
}

void Wavefront::report_visibility() {
    outcomes_.clear();
    for (std::size_t j = 0; j < contributions_.size(); ++j) {
        const std::uint32_t vertex = contributions_[j].vertex;
        if (vertex == kNone) continue;
        const Selection& selection = selections_[vertex];
        const float visibility = occluded_[j] == 0 ? 1.0f : 0.0f;
        outcomes_.push_back({points_[vertex].position, points_[vertex].normal, selection.receipt,
                             selection.light, visibility});
    }
    pass_->sampler.report(outcomes_);
}

Wavefront::LightSample Wavefront::sample_light(std::size_t vertex,
                                               const PixelNumbers& numbers) const noexcept {
    const Surface& surface = surfaces_[vertex];
    const Selection& selection = selections_[vertex];
    if (!(selection.prob > 0.0f)) return {};
    const EmitterSample s = sample_emitter(pass_->scene, pass_->scene.emitters[selection.light],
                                           surface.position, numbers.light_vertex());
    if (!(s.pdf > 0.0f) || s.direction.dot(surface.normal) <= 0.0f) return {};
    const BsdfValue bsdf = surface.bsdf.evaluate(s.direction);
    const V3f value = path_of(vertex).throughput * bsdf.value * s.radiance;
    if (value == V3f(0.0f)) return {};
    float vertex_prob = 1.0f;
    if (pass_->vertex_culling != nullptr) {
        vertex_prob = pass_->vertex_culling->vertex_prob(points_[vertex], selection.receipt,
                                                         selection.light, to_float3(s.place));
        if (!(vertex_prob > 0.0f)) return {};
    }

    float weight = 1.0f;
    if (pass_->settings.direct_light == DirectLight::kMis && !s.is_delta) {
        const float light_pdf = selection.mis_prob * s.pdf;
        weight = light_pdf / (light_pdf + ray_share(surface) * bsdf.pdf);
    }
    const float divisor = selection.prob * vertex_prob * s.pdf;
    return {s.shadow_ray(surface.origin), value * (weight / divisor)};
}

Wavefront::LightSample Wavefront::sample_environment(std::size_t vertex,
                                                     const PixelNumbers& numbers) const noexcept {
    const Surface& surface = surfaces_[vertex];
    const auto [cell, within] = numbers.environment();
    const EnvironmentSample s = pass_->scene.environment->sample(cell, within);
    if (!(s.pdf > 0.0f) || s.direction.dot(surface.normal) <= 0.0f) return {};
    const BsdfValue bsdf = surface.bsdf.evaluate(s.direction);
    const bool mis = pass_->settings.direct_light == DirectLight::kMis;
    const float weight = mis ? s.pdf / (s.pdf + ray_share(surface) * bsdf.pdf) : 1.0f;
    return {{surface.origin, s.direction},
            path_of(vertex).throughput * bsdf.value * s.radiance * (weight / s.pdf)};
}

/// The probability with which a path goes on from a surface. Where its next edge is the last and
/// finds nothing but emission, for which there is light sampling as well, less than a sample in the
/// mean is enough: the balance heuristic takes the share as the technique's number of samples
/// (Veach 1997, section 9.2; Grittmann et al. 2022, "Efficiency-aware multiple importance sampling
/// for bidirectional rendering algorithms").
float Wavefront::ray_share(const Surface& surface) const noexcept {
    const RenderSettings& settings = pass_->settings;
    const bool is_last = depth_ + 1 == settings.max_depth;
    const bool for_mis_alone = is_last && settings.direct_light == DirectLight::kMis;
    return for_mis_alone && surface.bsdf.is_broad() ? pass_->last_ray_share : 1.0f;
}

void Wavefront::scatter() {
    next_paths_.clear();
    next_rays_.clear();
    for (std::size_t k = 0; k < order_.size(); ++k) {
        const Path& path = path_of(k);
        const Surface& surface = surfaces_[k];
        const PixelNumbers numbers = numbers_of(path.pixel);
        const float share = ray_share(surface);
        if (share < 1.0f && numbers.last_ray() >= share) continue;
        const PixelNumbers::Scatter u = numbers.scatter();
        const BsdfSample s = surface.bsdf.sample(u.lobe, u.direction);
        V3f throughput = path.throughput * s.weight * (1.0f / share);
        if (throughput == V3f(0.0f) || s.direction.dot(surface.normal) <= 0.0f) continue;
        if (depth_ >= pass_->settings.rr_depth) {
            constexpr float kMostLikely = 0.95f;
            const float survival = std::min(kMostLikely, max_component(throughput));
            if (numbers.roulette() >= survival) continue;
            throughput /= survival;
        }
        next_paths_.push_back({path.pixel, throughput, s.pdf * share, {}, selections_[k].receipt});
        if (needs_selection()) next_paths_.back().point = points_[k];
        next_rays_.push_back({surface.origin, s.direction});
    }
    paths_.swap(next_paths_);
    rays_.swap(next_rays_);
}

}  // namespace lightcull
