#include "scene/cut_triangles.h"

#include <mitsuba/core/warp.h>
#include <mitsuba/render/bsdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "arrays/evaluate.h"
#include "arrays/variants.h"
#include "scene/emission_lattice.h"
#include "scene/emission_probe.h"
#include "scene/lit_distances.h"
#include "scene/triangle_point.h"

namespace mitsuba::culling {
namespace {

using ::lightcull::PartEmission;
using ::lightcull::SubTriangle;
using ::lightcull::TriangleCorners;

/// The rays that leave a triangle, of which there are fewer where there are many triangles.
constexpr std::uint32_t kFewestRays = 32, kMostRays = 1024, kRays = 1 << 15;

/// The middles of the lattices of all triangles, and the size of one where there are no texels.
constexpr std::size_t kMostMiddles = 1 << 19;
constexpr float kSizeWithoutTexels = 32.0f;
constexpr std::uint32_t kSmallestSize = 4;
/// Middles to a texel along each axis, and those that are enough to see all that emits: with a
/// filter, there is light next to bright texels.
constexpr float kMiddlesPerTexel = 4.0f, kEnoughPerTexel = 2.0f;
/// The least emission of a part, as a share of the mean, where a lattice does not see all texels.
constexpr float kUnseen = 0.01f;

/// Number `index` of a sequence that fills a hypercube evenly, of its four coordinates one: see
/// core/render/lit_distance.cpp.
template <typename Float>
Float spread(const Float& index, int power) {
    const auto step = static_cast<float>(std::pow(1.1673039782614187, -power));
    const Float x = dr::fmadd(index + 1.0f, step, 0.5f);
    return x - dr::floor(x);
}

/// The corners and the normals of triangles, of which each lane takes one.
template <typename Float>
class TriangleColumns {
  public:
    using UInt32 = dr::uint32_array_t<Float>;
    using Point3f = Point<Float, 3>;
    using Vector3f = Vector<Float, 3>;

    template <typename Candidates>
    explicit TriangleColumns(const Candidates& candidates) : numbers_(numbers_of(candidates)) {}

    Point3f corner(const UInt32& triangle, std::uint32_t which) const {
        return Point3f(vector(triangle, 3 * which));
    }
    Vector3f normal(const UInt32& triangle) const { return vector(triangle, 9); }
    Float two_sided(const UInt32& triangle) const { return numbers_[triangle * kWords + 12]; }

  private:
    static constexpr std::uint32_t kWords = 13;

    template <typename Candidates>
    static std::vector<float> numbers_of(const Candidates& candidates) {
        std::vector<float> numbers;
        for (const auto& candidate : candidates) {
            const auto& [a, b, c] = candidate.corners;
            for (const auto& v : {a, b, c, candidate.normal}) {
                numbers.insert(numbers.end(), {v.x, v.y, v.z});
            }
            numbers.push_back(candidate.two_sided ? 1.0f : 0.0f);
        }
        return numbers;
    }
    Vector3f vector(const UInt32& triangle, std::uint32_t first) const {
        const UInt32 at = triangle * kWords + first;
        return {numbers_[at], numbers_[at + 1], numbers_[at + 2]};
    }

    Lookup<Float> numbers_;
};

/// Whether what was hit takes light, but for mirrors.
template <typename Float, typename Hit>
dr::mask_t<Float> takes_light(const Hit& hit) {
    if constexpr (dr::is_jit_v<Float>) {
        const auto valid = hit.is_valid();
        const auto bsdf = hit.shape->bsdf(valid);
        return valid && has_flag(bsdf->flags(valid), BSDFFlags::Smooth);
    } else {
        return hit.is_valid() && has_flag(hit.shape->bsdf()->flags(), BSDFFlags::Smooth);
    }
}

/// Sends rays from all candidates.
template <typename Float, typename Spectrum>
std::vector<LitDistances> trace_distances(
    const Scene<Float, Spectrum>* scene,
    const std::vector<CutCandidate<Float, Spectrum>>& candidates) {
    using Point2f = Point<Float, 2>;
    using Vector3f = Vector<Float, 3>;
    using Ray3f = Ray<Point<Float, 3>, Spectrum>;
    const auto count = static_cast<std::uint32_t>(candidates.size());
    if (count == 0) return {};
    const std::uint32_t rays = std::clamp(kRays / count, kFewestRays, kMostRays);
    const TriangleColumns<Float> triangles(candidates);
    const auto values = evaluate<3, Float>(count * rays, [&](const auto& lane) {
        const auto triangle = lane / rays, number = lane - triangle * rays;
        const Float index = to_float<Float>(number);
        Point2f uv(spread(index, 1), spread(index, 2));
        uv = dr::select(uv.x() + uv.y() > 1.0f, 1.0f - uv, uv);
        const Float half = 0.5f * index;
        const auto is_back = triangles.two_sided(triangle) > 0.0f && half != dr::floor(half);
        const Vector3f normal = triangles.normal(triangle);
        const Vector3f up = dr::select(is_back, -normal, normal);
        const Vector3f local =
            warp::square_to_cosine_hemisphere(Point2f(spread(index, 3), spread(index, 4)));
        const auto place = triangles.corner(triangle, 0) * (1.0f - uv.x() - uv.y()) +
                           triangles.corner(triangle, 1) * uv.x() +
                           triangles.corner(triangle, 2) * uv.y();
        const Float away = (1.0f + dr::max(dr::abs(place))) * math::RayEpsilon<Float>;
        const Ray3f ray(place + up * away, Frame<Float>(up).to_world(local), 0.0f, {});
        const auto hit = scene->ray_intersect_preliminary(ray, false, false, 0, 0, true);
        const Float distance =
            dr::select(takes_light<Float>(hit), hit.t, Float(dr::Infinity<float>));
        return std::array<Float, 3>{uv.x(), uv.y(), distance};
    });
    std::vector<LitDistances> distances;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        std::vector<LitDistances::Ray> of_one;
        for (std::size_t k = i * rays; k < (i + 1) * rays; ++k) {
            of_one.push_back({{values[0][k], values[1][k]}, values[2][k]});
        }
        distances.emplace_back(std::move(of_one));
    }
    return distances;
}

/// The size of the lattices of candidates from `first` to `end`, which share an emitter, and
/// whether they see all texels.
struct LatticeSize {
    std::uint32_t size;
    bool sees_all;
};

template <typename Float, typename Spectrum>
LatticeSize lattice_size(const CutCandidate<Float, Spectrum>* first,
                         const CutCandidate<Float, Spectrum>* end, std::size_t varying) {
    using Point2f = Point<Float, 2>;
    const float texels = EmissionProbe<Float, Spectrum>(first->emitter).texels();
    float wanted = kSizeWithoutTexels;
    if (texels > 0.0f) {
        std::vector<std::uint32_t> indices;
        for (auto* of_one = first; of_one != end; ++of_one) indices.push_back(of_one->triangle);
        const Lookup<dr::uint32_array_t<Float>> index(indices);
        const auto count = static_cast<std::uint32_t>(indices.size());
        const auto lengths = evaluate<1, Float>(count, [&](const auto& lane) {
            const auto at = [&](float u, float v) {
                return triangle_point<Float, Spectrum>(first->mesh, index[lane], Point2f(u, v)).uv;
            };
            const Point2f a = at(0.0f, 0.0f), b = at(1.0f, 0.0f), c = at(0.0f, 1.0f);
            const Float longest = dr::maximum(dr::norm(b - a), dr::norm(c - a));
            return std::array<Float, 1>{dr::maximum(longest, dr::norm(c - b))};
        });
        const float longest = *std::max_element(lengths[0].begin(), lengths[0].end());
        // Along the axes no edge is longer, but for those across, which are so by the root of 2.
        wanted = std::sqrt(0.5f) * kMiddlesPerTexel * texels * longest;
    }
    const double most = std::sqrt(static_cast<double>(kMostMiddles / varying));
    std::uint32_t size = kSmallestSize;
    while (static_cast<float>(size) < wanted * 0.999f && 2.0 * size <= most) size *= 2;
    const float enough = wanted * (kEnoughPerTexel / kMiddlesPerTexel * 0.999f);
    return {size, texels > 0.0f && static_cast<float>(size) >= enough};
}

/// Looks at the emission of the candidates whose emitters vary.
template <typename Float, typename Spectrum>
std::vector<std::optional<EmissionLattice>> emission_lattices(
    const std::vector<CutCandidate<Float, Spectrum>>& candidates) {
    using Probe = EmissionProbe<Float, Spectrum>;
    std::vector<std::optional<EmissionLattice>> lattices(candidates.size());
    const auto varies = [](const auto& candidate) { return Probe(candidate.emitter).varies(); };
    const auto varying =
        static_cast<std::size_t>(std::count_if(candidates.begin(), candidates.end(), varies));
    for (std::size_t first = 0, end; first < candidates.size(); first = end) {
        end = first + 1;
        if (!varies(candidates[first])) continue;
        while (end < candidates.size() && candidates[end].emitter == candidates[first].emitter) {
            ++end;
        }
        const auto [size, sees_all] =
            lattice_size(candidates.data() + first, candidates.data() + end, varying);
        std::vector<std::uint32_t> triangles;
        for (std::size_t i = first; i < end; ++i) triangles.push_back(candidates[i].triangle);
        const auto radiances =
            Probe(candidates[first].emitter).lattices(candidates[first].mesh, triangles, size);
        const std::size_t count = EmissionLattice::count(size);
        for (std::size_t i = first; i < end; ++i) {
            const float* const of_one = radiances.data() + (i - first) * count;
            lattices[i].emplace(size, ::lightcull::Span<const float>(of_one, count),
                                sees_all ? 0.0f : kUnseen);
        }
    }
    return lattices;
}

}  // namespace

template <typename Float, typename Spectrum>
::lightcull::TriangleCuts cut_triangles(
    const Scene<Float, Spectrum>* scene,
    const std::vector<CutCandidate<Float, Spectrum>>& candidates,
    const ::lightcull::CutLimits& limits) {
    const std::vector<LitDistances> distances = trace_distances(scene, candidates);
    const auto lattices = emission_lattices(candidates);
    std::vector<TriangleCorners> triangles;
    for (const auto& candidate : candidates) triangles.push_back(candidate.corners);
    ::lightcull::CutDemand demand;
    demand.emission = [&](std::uint32_t i, const SubTriangle& part) {
        if (lattices[i]) return lattices[i]->over(part);
        PartEmission even;
        even.mean = candidates[i].radiance;
        return even;
    };
    demand.distance = [&](std::uint32_t i, const SubTriangle& part) {
        return distances[i].from(part);
    };
    demand.least_flux = limits.least_flux;
    demand.most_lights = limits.most_lights;
    return {triangles, demand};
}

#define INSTANTIATE(Float, Spectrum)                                                      \
    template ::lightcull::TriangleCuts cut_triangles<Float, Spectrum>(                    \
        const Scene<Float, Spectrum>*, const std::vector<CutCandidate<Float, Spectrum>>&, \
        const ::lightcull::CutLimits&);
LIGHTCULL_VARIANTS(INSTANTIATE)

}  // namespace mitsuba::culling
