#include "scene/calibration_points.h"

#include <mitsuba/core/warp.h>

#include <cmath>

#include "arrays/evaluate.h"
#include "arrays/variants.h"

namespace mitsuba::culling {
namespace {

constexpr std::uint32_t kRow = 12, kRays = kRow * kRow;
/// The fields of what a ray meets: its position, its normal, and whether there is anything.
constexpr std::size_t kFields = 7;

template <typename Float, typename SurfaceInteraction3f>
std::array<Float, kFields> fields(const SurfaceInteraction3f& si) {
    const auto n = dr::mulsign(si.sh_frame.n, si.wi.z());
    return {si.p.x(),
            si.p.y(),
            si.p.z(),
            n.x(),
            n.y(),
            n.z(),
            dr::select(si.is_valid(), Float(1.0f), Float(0.0f))};
}

}  // namespace

template <typename Float, typename Spectrum>
std::vector<::lightcull::ShadingPoint> calibration_points(const Scene<Float, Spectrum>* scene,
                                                          const Sensor<Float, Spectrum>* sensor) {
    using Point2f = Point<Float, 2>;
    using Vector3f = Vector<Float, 3>;
    using Ray3f = Ray<Point<Float, 3>, Spectrum>;
    using SurfaceInteraction3f = SurfaceInteraction<Float, Spectrum>;
    const auto values = evaluate<2 * kFields, Float>(kRays, [&](const auto& lane) {
        const auto row = lane / kRow;
        const Point2f place((to_float<Float>(lane - row * kRow) + 0.5f) / kRow,
                            (to_float<Float>(row) + 0.5f) / kRow);
        const Ray3f ray(
            sensor->sample_ray(sensor->shutter_open(), 0.5f, place, Point2f(0.5f)).first);
        const SurfaceInteraction3f seen = scene->ray_intersect(ray);
        // Any direction off the surface will do.
        const Float u = to_float<Float>(lane) * 0.7548777f, v = to_float<Float>(lane) * 0.5698403f;
        const Vector3f off =
            warp::square_to_cosine_hemisphere(Point2f(u - dr::floor(u), v - dr::floor(v)));
        const Vector3f up = dr::mulsign(off, seen.wi.z());
        const SurfaceInteraction3f next =
            scene->ray_intersect(seen.spawn_ray(seen.to_world(up)), seen.is_valid());
        std::array<Float, 2 * kFields> both;
        const auto first = fields<Float>(seen), second = fields<Float>(next);
        for (std::size_t k = 0; k < kFields; ++k) {
            both[k] = first[k];
            both[k + kFields] = second[k];
        }
        both[2 * kFields - 1] *= first[kFields - 1];
        return both;
    });
    std::vector<::lightcull::ShadingPoint> points;
    for (const std::size_t first : {std::size_t{0}, kFields}) {
        for (std::size_t i = 0; i < kRays; ++i) {
            const auto field = [&](std::size_t k) { return values[first + k][i]; };
            if (field(kFields - 1) == 0.0f) continue;
            ::lightcull::ShadingPoint point;
            point.position = {field(0), field(1), field(2)};
            point.normal = {field(3), field(4), field(5)};
            points.push_back(point);
        }
    }
    return points;
}

#define INSTANTIATE(Float, Spectrum)                                                     \
    template std::vector<::lightcull::ShadingPoint> calibration_points<Float, Spectrum>( \
        const Scene<Float, Spectrum>*, const Sensor<Float, Spectrum>*);
LIGHTCULL_VARIANTS(INSTANTIATE)

}  // namespace mitsuba::culling
