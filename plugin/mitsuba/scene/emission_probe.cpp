#include "scene/emission_probe.h"

#include <mitsuba/core/warp.h>
#include <mitsuba/render/texture.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <typeinfo>

#include "arrays/evaluate.h"
#include "arrays/variants.h"
#include "scene/emission_lattice.h"
#include "scene/triangle_point.h"

namespace mitsuba::culling {
namespace {

/// The points per triangle where radiance varies; there are fewer where there are many triangles.
constexpr std::uint32_t kFewestPoints = 16, kMostPoints = 1024, kPointsPerMesh = 1 << 16;
/// The points, each with wavelengths of its own, where radiance does not vary.
constexpr std::uint32_t kSpectralPoints = 16;
/// The directions from which a point is looked at: angles from its axis, times angles about it.
constexpr std::uint32_t kPolarSteps = 512, kAzimuthSteps = 8;
constexpr float kNearlyPeak = 0.9f;
/// The samples that are taken of an emitter without a place, and the directions of an environment.
constexpr std::uint32_t kSamples = 64, kDirections = 4096;

/// Two numbers in [0, 1) that spread evenly (the R2 sequence).
template <typename Float>
Point<Float, 2> spread(const Float& index) {
    const Float u = dr::fmadd(index, 0.7548777f, 0.5f), v = dr::fmadd(index, 0.5698403f, 0.5f);
    return {u - dr::floor(u), v - dr::floor(v)};
}

/// The wavelengths of an index, spread over the visible range; each index has others. In RGB there
/// are none.
template <typename Float, typename Spectrum>
wavelength_t<Spectrum> wavelengths(const Float& index) {
    if constexpr (is_spectral_v<Spectrum>) {
        const Float offset = spread<Float>(index).x();
        const auto place = (dr::arange<wavelength_t<Spectrum>>() + offset) /
                           static_cast<float>(dr::size_v<wavelength_t<Spectrum>>);
        return MI_CIE_MIN + place * (MI_CIE_MAX - MI_CIE_MIN);
    } else {
        DRJIT_MARK_USED(index);
        return {};
    }
}

template <typename Float, typename Spectrum>
Float absolute_luminance(const Spectrum& value, const wavelength_t<Spectrum>& wavelengths) {
    const Float result = dr::abs(luminance(value, wavelengths));
    // Film values are integrals over the wavelengths; luminance() takes their mean.
    constexpr double kRange = (MI_CIE_MAX - MI_CIE_MIN) * MI_CIE_Y_NORMALIZATION;
    return is_spectral_v<Spectrum> ? result * static_cast<float>(kRange) : result;
}

/// The front and back radiance (luminance) at a point of a surface.
template <typename Float, typename Spectrum>
std::array<Float, 2> both_sides(const Emitter<Float, Spectrum>* emitter,
                                SurfaceInteraction<Float, Spectrum> si) {
    std::array<Float, 2> result;
    for (std::size_t side = 0; side < 2; ++side) {
        si.wi = Vector<Float, 3>(0.0f, 0.0f, side == 0 ? 1.0f : -1.0f);
        result[side] = absolute_luminance<Float, Spectrum>(emitter->eval(si, true), si.wavelengths);
    }
    return result;
}

/// Looks for the texture of an emitter.
template <typename Float, typename Spectrum>
class TexelCounter final : public TraversalCallback {
  public:
    float texels = 0.0f;

  protected:
    void put_object(std::string_view, Object* object, std::uint32_t) override {
        auto* const texture = dynamic_cast<Texture<Float, Spectrum>*>(object);
        if (texture == nullptr) return;
        const auto size = texture->resolution();
        // Those without texels say that they have one.
        if (dr::prod(size) == 1) return;
        scale_ = 1.0f;
        texture->traverse(this);
        texels = std::max(texels, scale_ * static_cast<float>(dr::max(size)));
    }
    void put_value(std::string_view name, void* value, std::uint32_t,
                   const std::type_info& type) override {
        using Transform = AffineTransform<Point<Float, 3>>;
        if (name != "to_uv" || type != typeid(Transform)) return;
        const auto& matrix = static_cast<const Transform*>(value)->matrix;
        const auto scale = evaluate<1, Float>(1, [&](const auto&) {
            const auto length = [&](std::size_t column) {
                return dr::sqrt(dr::square(matrix(0, column)) + dr::square(matrix(1, column)));
            };
            return std::array<Float, 1>{dr::maximum(length(0), length(1))};
        });
        scale_ = scale[0][0];
    }

  private:
    float scale_ = 1.0f;
};

float mean(const float* values, std::size_t count) {
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) sum += static_cast<double>(values[i]);
    return static_cast<float>(sum / static_cast<double>(count));
}

}  // namespace

template <typename Float, typename Spectrum>
std::vector<Emission> EmissionProbe<Float, Spectrum>::triangles(const Mesh* mesh) const {
    const std::uint32_t triangles = mesh->face_count();
    std::vector<Emission> result(triangles);
    if (triangles == 0) return result;
    std::uint32_t points = is_spectral_v<Spectrum> ? kSpectralPoints : 1;
    if (varies()) points = std::clamp(kPointsPerMesh / triangles, kFewestPoints, kMostPoints);
    const std::uint32_t probed = varies() ? triangles : 1;
    const auto radiance = evaluate<2, Float>(probed * points, [&](const auto& lane) {
        const auto triangle = lane / points;
        const Float index = to_float<Float>(lane - triangle * points);
        Point2f uv = spread<Float>(index);
        uv = dr::select(uv.x() + uv.y() > 1.0f, 1.0f - uv, uv);
        SurfaceInteraction3f si = triangle_point<Float, Spectrum>(mesh, triangle, uv);
        si.wavelengths = wavelengths<Float, Spectrum>(index);
        return both_sides<Float, Spectrum>(emitter_, si);
    });
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const std::size_t first = std::size_t{std::min(i, probed - 1)} * points;
        result[i] = {mean(&radiance[0][first], points), mean(&radiance[1][first], points)};
    }
    return result;
}

template <typename Float, typename Spectrum>
std::vector<float> EmissionProbe<Float, Spectrum>::lattices(
    const Mesh* mesh, const std::vector<std::uint32_t>& triangles, std::uint32_t size) const {
    using UInt32 = dr::uint32_array_t<Float>;
    const Lookup<UInt32> index(triangles);
    const std::uint32_t middles = size * size;
    const auto places = static_cast<std::uint32_t>(EmissionLattice::count(size));
    const auto count = static_cast<std::uint32_t>(triangles.size()) * places;
    // The same wavelengths everywhere, so that they make nothing uneven.
    constexpr std::uint32_t kShifts = is_spectral_v<Spectrum> ? 4 : 1;
    std::vector<float> sums(count, 0.0f);
    for (std::uint32_t shift = 0; shift < kShifts; ++shift) {
        const auto radiance = evaluate<2, Float>(count, [&](const auto& lane) {
            const UInt32 triangle = lane / places, place = lane - triangle * places;
            const auto is_corner = place >= middles;
            const UInt32 edge = dr::select(is_corner, UInt32(size + 1), UInt32(size));
            const UInt32 number = dr::select(is_corner, place - middles, place);
            const UInt32 row = number / edge, column = number - row * edge;
            const Float offset =
                dr::select(is_corner, Float(0.0f), Float(EmissionLattice::kOffset));
            const Point2f uv((to_float<Float>(column) + offset) / static_cast<float>(size),
                             (to_float<Float>(row) + offset) / static_cast<float>(size));
            // Corners beyond the triangle are mirrored, too, so that they are on it.
            const Point2f inside = dr::select(uv.x() + uv.y() > 1.0f, 1.0f - uv, uv);
            SurfaceInteraction3f si =
                triangle_point<Float, Spectrum>(mesh, index[triangle], inside);
            si.wavelengths = wavelengths<Float, Spectrum>(Float(static_cast<float>(shift)));
            return both_sides<Float, Spectrum>(emitter_, si);
        });
        for (std::size_t i = 0; i < count; ++i) {
            sums[i] += std::max(radiance[0][i], radiance[1][i]) / static_cast<float>(kShifts);
        }
    }
    return sums;
}

template <typename Float, typename Spectrum>
float EmissionProbe<Float, Spectrum>::texels() const {
    TexelCounter<Float, Spectrum> counter;
    const_cast<Emitter*>(emitter_)->traverse(&counter);
    return counter.texels;
}

template <typename Float, typename Spectrum>
Emission EmissionProbe<Float, Spectrum>::shape() const {
    const std::uint32_t points = varies() ? kMostPoints : kSpectralPoints;
    const auto radiance = evaluate<2, Float>(points, [&](const auto& lane) {
        const Float index = to_float<Float>(lane);
        const PositionSample3f position =
            emitter_->shape()->sample_position(0.0f, spread<Float>(index), true);
        SurfaceInteraction3f si(position, wavelengths<Float, Spectrum>(index));
        si.shape = emitter_->shape();
        return both_sides<Float, Spectrum>(emitter_, si);
    });
    return {mean(radiance[0].data(), points), mean(radiance[1].data(), points)};
}

template <typename Float, typename Spectrum>
PointEmission EmissionProbe<Float, Spectrum>::point() const {
    const auto axis_values = evaluate<3, Float>(1, [&](const auto&) {
        const Vector3f axis =
            dr::normalize(emitter_->world_transform() * Vector3f(0.0f, 0.0f, 1.0f));
        return std::array<Float, 3>{axis.x(), axis.y(), axis.z()};
    });
    const auto place = emitter_->bbox().center();
    PointEmission result;
    result.position = {place.x(), place.y(), place.z()};
    result.axis = {axis_values[0][0], axis_values[1][0], axis_values[2][0]};

    const Vector3f axis(result.axis.x, result.axis.y, result.axis.z);
    const auto across = coordinate_system(axis);
    const Vector3f s = across.first, t = across.second;
    const auto seen = evaluate<1, Float>(kPolarSteps * kAzimuthSteps, [&](const auto& lane) {
        const auto step = lane / kAzimuthSteps;
        const Float polar = (to_float<Float>(step) + 0.5f) * (dr::Pi<float> / kPolarSteps);
        const Float azimuth = to_float<Float>(lane) * 2.39996323f;
        const auto [sin_polar, cos_polar] = dr::sincos(polar);
        const auto [sin_azimuth, cos_azimuth] = dr::sincos(azimuth);
        const Vector3f direction =
            axis * cos_polar + (s * cos_azimuth + t * sin_azimuth) * sin_polar;
        auto from = dr::zeros<Interaction3f>(dr::width(lane));
        from.p = Point3f(place) + direction;
        from.wavelengths = wavelengths<Float, Spectrum>(to_float<Float>(lane));
        const auto value = emitter_->sample_direction(from, Point2f(0.5f), true).second;
        return std::array<Float, 1>{absolute_luminance<Float, Spectrum>(value, from.wavelengths)};
    });

    std::vector<float> profile(kPolarSteps);
    for (std::uint32_t i = 0; i < kPolarSteps; ++i) {
        profile[i] = mean(&seen[0][std::size_t{i} * kAzimuthSteps], kAzimuthSteps);
        // A value that is no number stays.
        if (!(profile[i] <= result.peak) && !std::isnan(result.peak)) result.peak = profile[i];
    }
    // A spot's fall-off is known by its angle alone; of anything else only the peak is used.
    const bool is_spot = emitter_->class_name() == "SpotLight" && !varies();
    if (!is_spot) result.inner = result.outer = dr::Pi<float>;
    for (std::size_t i = 0; i < kPolarSteps && is_spot; ++i) {
        // The light may end anywhere before the next step.
        const float angle = std::min(static_cast<float>(i) + 1.5f, float{kPolarSteps}) *
                            (dr::Pi<float> / kPolarSteps);
        if (profile[i] > 0.0f) result.outer = angle;
        if (profile[i] > kNearlyPeak * result.peak) result.inner = angle;
    }
    return result;
}

template <typename Float, typename Spectrum>
DirectionalEmission EmissionProbe<Float, Spectrum>::directional(const ScalarPoint3f& point) const {
    const auto way = evaluate<3, Float>(1, [&](const auto&) {
        auto from = dr::zeros<Interaction3f>();
        from.p = Point3f(point);
        const Vector3f d = emitter_->sample_direction(from, Point2f(0.5f), true).first.d;
        return std::array<Float, 3>{d.x(), d.y(), d.z()};
    });
    return {{-way[0][0], -way[1][0], -way[2][0]}, mean_of_samples(point)};
}

template <typename Float, typename Spectrum>
float EmissionProbe<Float, Spectrum>::mean_of_samples(const ScalarPoint3f& point) const {
    const auto seen = evaluate<1, Float>(kSamples, [&](const auto& lane) {
        const Float index = to_float<Float>(lane);
        auto from = dr::zeros<Interaction3f>(dr::width(lane));
        from.p = Point3f(point);
        from.wavelengths = wavelengths<Float, Spectrum>(index);
        const Spectrum weight = emitter_->sample_direction(from, spread<Float>(index), true).second;
        return std::array<Float, 1>{absolute_luminance<Float, Spectrum>(weight, from.wavelengths)};
    });
    return mean(seen[0].data(), kSamples);
}

template <typename Float, typename Spectrum>
float EmissionProbe<Float, Spectrum>::mean_of_environment() const {
    const auto seen = evaluate<1, Float>(kDirections, [&](const auto& lane) {
        const Float index = to_float<Float>(lane);
        auto si = dr::zeros<SurfaceInteraction3f>(dr::width(lane));
        si.wi = warp::square_to_uniform_sphere(spread<Float>(index));
        si.wavelengths = wavelengths<Float, Spectrum>(index);
        const Spectrum radiance = emitter_->eval(si, true);
        return std::array<Float, 1>{absolute_luminance<Float, Spectrum>(radiance, si.wavelengths)};
    });
    return mean(seen[0].data(), kDirections);
}

template <typename Float, typename Spectrum>
bool EmissionProbe<Float, Spectrum>::can_be_sampled(const ScalarPoint3f& point) const {
    const float sampled = mean_of_samples(point);
    if (!std::isfinite(sampled)) return false;
    if (!emitter_->is_environment()) return true;
    // One bad texel of a map spoils the samples of all.
    const float there = mean_of_environment();
    return std::isfinite(there) && (there == 0.0f || sampled > 0.0f);
}

#define INSTANTIATE(Float, Spectrum) template class EmissionProbe<Float, Spectrum>;
LIGHTCULL_VARIANTS(INSTANTIATE)

}  // namespace mitsuba::culling
