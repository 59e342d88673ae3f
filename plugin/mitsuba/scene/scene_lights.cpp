#include "scene/scene_lights.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "arrays/evaluate.h"
#include "arrays/variants.h"
#include "scene/emission_probe.h"
#include "scene/triangle_point.h"

namespace mitsuba::culling {
namespace {

using ::lightcull::float3;
using ::lightcull::Light;
using ::lightcull::TriangleCorners;

bool finite(const float3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The name that users know an emitter by.
template <typename Emitter>
std::string name_of(const Emitter* emitter) {
    std::string name = "emitter \"" + std::string(emitter->id()) + "\"";
    if (emitter->shape()) name += " of shape \"" + std::string(emitter->shape()->id()) + "\"";
    return name;
}

/// The corners of all triangles of a mesh.
template <typename Float, typename Spectrum>
std::vector<TriangleCorners> corners_of(const Mesh<Float, Spectrum>* mesh) {
    const std::size_t count = mesh->face_count();
    const auto positions =
        to_host<float>(mesh->vertex_positions_buffer(), 3 * std::size_t{mesh->vertex_count()});
    const auto corners = to_host<std::uint32_t>(mesh->faces_buffer(), 3 * count);
    const auto corner = [&](std::size_t i) {
        const float* p = &positions[3 * std::size_t{corners[i]}];
        return float3{p[0], p[1], p[2]};
    };
    std::vector<TriangleCorners> triangles(count);
    for (std::size_t i = 0; i < count; ++i) {
        triangles[i] = {corner(3 * i), corner(3 * i + 1), corner(3 * i + 2)};
    }
    return triangles;
}

float area_of(const TriangleCorners& t) {
    return ::lightcull::triangle_light(t.a, t.b, t.c, 1.0f).intensity;
}

/// The light that is a triangle, or a part of one: it faces the way of `axis`.
Light light_of(const TriangleCorners& t, const float3& axis, float radiance, bool two_sided) {
    Light light = ::lightcull::triangle_light(t.a, t.b, t.c, radiance, two_sided);
    const float3 n = light.axis;
    if (n.x * axis.x + n.y * axis.y + n.z * axis.z < 0.0f) light.axis = {-n.x, -n.y, -n.z};
    return light;
}

float3 place_of(const TriangleCorners& t, const ::lightcull::float2& at) {
    const auto along = [&](float a, float b, float c) {
        return a + (b - a) * at.x + (c - a) * at.y;
    };
    return {along(t.a.x, t.b.x, t.c.x), along(t.a.y, t.b.y, t.c.y), along(t.a.z, t.b.z, t.c.z)};
}

template <typename Shape>
bool is_rectangle(const Shape* shape) {
    return shape->shape_type() == +ShapeType::Rectangle;
}

/// Which way each triangle of a mesh faces, and how far its shading normals turn from that.
struct Facing {
    std::vector<float> side;        ///< < 0 where the normal is not that of the corners' order
    std::vector<float> cos_spread;  ///< cosine of the largest angle to a shading normal
};

template <typename Float, typename Spectrum>
Facing facing_of(const Mesh<Float, Spectrum>* mesh) {
    const std::uint32_t count = mesh->face_count();
    Facing facing{std::vector<float>(count, mesh->has_flipped_normals() ? -1.0f : 1.0f),
                  std::vector<float>(count, 1.0f)};
    if (!mesh->has_vertex_normals() || count == 0) return facing;
    using Point2f = Point<Float, 2>;
    const auto values = evaluate<2, Float>(count, [&](const auto& triangle) {
        const auto at = [&](float u, float v) {
            return triangle_point<Float, Spectrum>(mesh, triangle, Point2f(u, v));
        };
        const auto corners = mesh->face_indices(triangle);
        const auto a = mesh->vertex_position(corners[0]), b = mesh->vertex_position(corners[1]),
                   c = mesh->vertex_position(corners[2]);
        const auto first = at(0.0f, 0.0f), second = at(1.0f, 0.0f), third = at(0.0f, 1.0f);
        const Float side = dr::dot(dr::cross(b - a, c - a), first.n);
        const Float spread = dr::minimum(
            dr::dot(first.n, first.sh_frame.n),
            dr::minimum(dr::dot(first.n, second.sh_frame.n), dr::dot(first.n, third.sh_frame.n)));
        return std::array<Float, 2>{side, spread};
    });
    return {values[0], values[1]};
}

}  // namespace

template <typename Float, typename Spectrum>
SceneLights<Float, Spectrum>::SceneLights(const Scene* scene) {
    const auto box = scene->bbox();
    middle_ = box.valid() ? box.center() : ScalarPoint3f(0.0f);
    for (const auto& emitter : scene->emitters()) add(emitter.get());
    float weights = 0.0f;
    for (const Unplaced& unplaced : unplaced_) weights += unplaced.prob;
    for (Unplaced& unplaced : unplaced_) unplaced.prob /= weights;
    uncut_count_ = lights_.size();
    cut(scene);
}

template <typename Float, typename Spectrum>
float SceneLights<Float, Spectrum>::unplaced_prob(const Emitter* emitter) const {
    for (const Unplaced& unplaced : unplaced_) {
        if (unplaced.emitter == emitter) return unplaced.prob;
    }
    return 0.0f;
}

template <typename Float, typename Spectrum>
void SceneLights<Float, Spectrum>::add(const Emitter* emitter) {
    if (!(emitter->sampling_weight() > 0.0f)) return;
    const std::uint32_t flags = emitter->flags();
    const bool is_surface = has_flag(flags, EmitterFlags::Surface) && emitter->shape() &&
                            !has_flag(flags, EmitterFlags::DeltaDirection);
    if (is_surface) {
        // A rectangle is a mesh to Mitsuba, but not to those who sample it.
        const auto* mesh = dynamic_cast<const Mesh*>(emitter->shape());
        mesh && !is_rectangle(mesh) ? add_mesh(emitter, mesh) : add_shape(emitter);
    } else if (has_flag(flags, EmitterFlags::DeltaPosition) && emitter->bbox().valid()) {
        add_point(emitter);
    } else if (has_flag(flags, EmitterFlags::Infinite) &&
               has_flag(flags, EmitterFlags::DeltaDirection)) {
        add_directional(emitter);
    } else {
        add_unplaced(emitter);
    }
}

template <typename Float, typename Spectrum>
void SceneLights<Float, Spectrum>::add_mesh(const Emitter* emitter, const Mesh* mesh) {
    const std::size_t first = lights_.size();
    const std::vector<TriangleCorners> triangles = corners_of(mesh);
    const auto emission = EmissionProbe<Float, Spectrum>(emitter).triangles(mesh);
    const Facing facing = facing_of<Float, Spectrum>(mesh);
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        auto [a, b, c] = triangles[i];
        const auto [front, back] = emission[i];
        if ((facing.side[i] < 0.0f) != (front == 0.0f && back > 0.0f)) std::swap(b, c);
        const bool two_sided = front > 0.0f && back > 0.0f;
        Light light = ::lightcull::triangle_light(a, b, c, std::max(front, back), two_sided);
        // Light leaves by the shading normal's side. A cosine of 1 would say that it is flat.
        constexpr float kFlat = 0.9999f;
        if (facing.cos_spread[i] < kFlat) {
            light.cos_theta_o = facing.cos_spread[i] > 0.0f ? facing.cos_spread[i] : -1.0f;
        }
        add_light(emitter, light, {i, triangles[i]}, area_of(triangles[i]));
    }
    close_source(emitter, mesh, first);
}

template <typename Float, typename Spectrum>
void SceneLights<Float, Spectrum>::add_shape(const Emitter* emitter) {
    const std::size_t first = lights_.size();
    const Shape* shape = emitter->shape();
    const auto box = shape->bbox();
    const float3 low{box.min.x(), box.min.y(), box.min.z()};
    const float3 high{box.max.x(), box.max.y(), box.max.z()};
    const Emission emission = EmissionProbe<Float, Spectrum>(emitter).shape();
    const auto values = evaluate<4, Float>(1, [&](const auto&) {
        const auto normal = shape->sample_position(0.0f, Point2f(0.5f), true).n;
        return std::array<Float, 4>{shape->surface_area(), normal.x(), normal.y(), normal.z()};
    });
    const float area = values[0][0];
    float3 normal{values[1][0], values[2][0], values[3][0]};
    const float radiance = std::max(emission.front, emission.back);
    const bool two_sided = emission.front > 0.0f && emission.back > 0.0f;
    if (emission.front == 0.0f) normal = {-normal.x, -normal.y, -normal.z};
    if (area == 0.0f) normal = {0, 0, 1};  // it has none

    const std::uint32_t type = shape->shape_type();
    Light light;
    if (type == +ShapeType::Rectangle || type == +ShapeType::Disk) {
        constexpr float kPower = dr::Pi<float>;  // of a flat light of intensity 1
        light = ::lightcull::bounded_light(low, high, normal, 1.0f, 0.0f, two_sided,
                                           radiance * area * kPower * (two_sided ? 2.0f : 1.0f));
        light.cos_theta_o = 1.0f;  // its plane goes through the middle of its bounds
    } else {
        light = ::lightcull::bounded_light(low, high, {0, 0, 1}, -1.0f, 0.0f, false,
                                           radiance * area * dr::Pi<float>);
    }
    if (type == +ShapeType::Sphere) light.radius = 0.5f * (high.x - low.x);
    add_light(emitter, light);
    close_source(emitter, nullptr, first);
}

template <typename Float, typename Spectrum>
void SceneLights<Float, Spectrum>::add_point(const Emitter* emitter) {
    const PointEmission emission = EmissionProbe<Float, Spectrum>(emitter).point();
    // A beam that the probe missed must still be sampled, since no ray can hit a point.
    if (emission.peak == 0.0f) {
        add_unplaced(emitter);
        return;
    }
    const std::size_t first = lights_.size();
    add_light(emitter, emission.inner < dr::Pi<float>
                           ? ::lightcull::spot_light(emission.position, emission.axis,
                                                     emission.peak, emission.inner, emission.outer)
                           : ::lightcull::point_light(emission.position, emission.peak));
    close_source(emitter, nullptr, first);
}

template <typename Float, typename Spectrum>
void SceneLights<Float, Spectrum>::add_directional(const Emitter* emitter) {
    const DirectionalEmission emission =
        EmissionProbe<Float, Spectrum>(emitter).directional(middle_);
    const std::size_t first = lights_.size();
    add_light(emitter, ::lightcull::directional_light(emission.direction, emission.irradiance));
    close_source(emitter, nullptr, first);
}

template <typename Float, typename Spectrum>
void SceneLights<Float, Spectrum>::add_unplaced(const Emitter* emitter) {
    if (!EmissionProbe<Float, Spectrum>(emitter).can_be_sampled(middle_)) {
        Throw("lightcull: %s: its radiance or place is not finite", name_of(emitter));
    }
    unplaced_.push_back({emitter, emitter->sampling_weight()});
}

template <typename Float, typename Spectrum>
void SceneLights<Float, Spectrum>::add_light(const Emitter* emitter, const Light& light,
                                             const Triangle& triangle, float area) {
    const auto& [a, b, c] = triangle.corners;
    if (!finite(a) || !finite(b) || !finite(c) || !finite(light.center) ||
        !std::isfinite(light.radius)) {
        Throw("lightcull: %s: its geometry is not finite", name_of(emitter));
    }
    if (!std::isfinite(light.intensity)) {
        Throw("lightcull: %s: its radiance is not finite", name_of(emitter));
    }
    source_of_.push_back(static_cast<std::uint32_t>(sources_.size()));
    lights_.push_back(light);
    triangles_.push_back(triangle);
    places_.add(area);
}

template <typename Float, typename Spectrum>
void SceneLights<Float, Spectrum>::close_source(const Emitter* emitter, const Mesh* mesh,
                                                std::size_t first) {
    index_[emitter] = static_cast<std::uint32_t>(sources_.size());
    sources_.push_back({emitter, mesh, static_cast<std::uint32_t>(first),
                        static_cast<std::uint32_t>(lights_.size() - first)});
}

template <typename Float, typename Spectrum>
void SceneLights<Float, Spectrum>::cut(const Scene* scene) {
    const ::lightcull::CutLimits limits = ::lightcull::cut_limits(lights_);
    std::vector<Candidate> found = candidates(limits.least_flux);
    if (!found.empty()) take_parts(found, cut_triangles(scene, found, limits));
}

/// The triangles, halves of rectangles among them, that may be worth a cut.
template <typename Float, typename Spectrum>
auto SceneLights<Float, Spectrum>::candidates(double least_flux) const -> std::vector<Candidate> {
    std::vector<Candidate> found;
    for (const Source& source : sources_) {
        // A texture may shine where the probe has not looked.
        constexpr std::uint32_t kFew = 1024;
        const bool all =
            source.count <= kFew && EmissionProbe<Float, Spectrum>(source.emitter).varies();
        const auto is_worth_it = [&](std::uint32_t light) {
            return all || static_cast<double>(lights_[light].intensity) > least_flux;
        };
        const auto consider = [&](const Mesh* mesh, std::uint32_t index, std::uint32_t light,
                                  const TriangleCorners& corners, float area) {
            const Light& of = lights_[light];
            if (!is_worth_it(light) || !(area > 0.0f)) return;
            found.push_back({source.emitter, mesh, index, light, corners, of.axis, of.two_sided,
                             of.intensity / area});
        };
        if (source.mesh) {
            for (std::uint32_t i = 0; i < source.count; ++i) {
                const std::uint32_t light = source.first + i;
                consider(source.mesh, i, light, triangles_[light].corners, places_.area(light));
            }
        } else if (source.emitter->shape() && is_rectangle(source.emitter->shape()) &&
                   is_worth_it(source.first)) {
            const auto* mesh = dynamic_cast<const Mesh*>(source.emitter->shape());
            const auto halves = corners_of(mesh);
            const float area = area_of(halves[0]) + area_of(halves[1]);
            for (std::uint32_t i = 0; i < 2; ++i) consider(mesh, i, source.first, halves[i], area);
        }
    }
    return found;
}

/// Makes two triangles of a rectangle, which goes on as a light that does not shine.
template <typename Float, typename Spectrum>
void SceneLights<Float, Spectrum>::open_rectangle(Candidate* halves) {
    const std::uint32_t whole = halves[0].light;
    const auto first = static_cast<std::uint32_t>(lights_.size());
    const std::uint32_t number = source_of_[whole];
    for (std::uint32_t i = 0; i < 2; ++i) {
        Candidate& half = halves[i];
        half.light = first + i;
        lights_.push_back(light_of(half.corners, half.normal, half.radiance, half.two_sided));
        triangles_.push_back({half.triangle, half.corners});
        places_.add(area_of(half.corners));
        source_of_.push_back(number);
    }
    lights_[whole].intensity = 0.0f;
    sources_[number].mesh = halves[0].mesh;
    sources_[number].first = first;
    sources_[number].count = 2;
}

template <typename Float, typename Spectrum>
void SceneLights<Float, Spectrum>::take_parts(std::vector<Candidate>& candidates,
                                              ::lightcull::TriangleCuts cuts) {
    for (std::uint32_t i = 0; i + 1 < candidates.size(); ++i) {
        const bool is_open =
            !source_of(candidates[i].light).mesh && (cuts.is_cut(i) || cuts.is_cut(i + 1));
        if (is_open && candidates[i].light == candidates[i + 1].light) {
            open_rectangle(&candidates[i]);
        }
    }
    places_.take(std::move(cuts));
    const auto parts = places_.cuts().parts();
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
        const std::uint32_t triangle = parts[i].triangle;
        const Candidate& candidate = candidates[triangle];
        std::uint32_t light = candidate.light;
        const bool is_whole = !places_.cuts().is_cut(triangle);
        // What is known of a whole rectangle stays.
        if (is_whole && !(places_.area(light) > 0.0f)) continue;
        const bool is_first = i == 0 || parts[i - 1].triangle != triangle;
        if (is_first && !is_whole) places_.set_triangle(light, triangle);
        if (!is_first) {
            light = static_cast<std::uint32_t>(lights_.size());
            lights_.emplace_back();
            triangles_.push_back(triangles_[candidate.light]);
            places_.add(places_.area(candidate.light));
            source_of_.push_back(source_of_[candidate.light]);
        }
        const auto& [a, b, c] = parts[i].corners.corners;
        const TriangleCorners& whole = candidate.corners;
        const float spread = lights_[candidate.light].cos_theta_o;
        lights_[light] = light_of({place_of(whole, a), place_of(whole, b), place_of(whole, c)},
                                  candidate.normal, parts[i].radiance, candidate.two_sided);
        lights_[light].cos_theta_o = spread;
        if (!is_whole) places_.set_part(light, i);
    }
}

#define INSTANTIATE(Float, Spectrum) template class SceneLights<Float, Spectrum>;
LIGHTCULL_VARIANTS(INSTANTIATE)

}  // namespace mitsuba::culling
