#include "virtual_lights/maps/imperfect_shadow_maps.h"

#include "base/parallel_blocks.h"
#include "base/random.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lightcull {
namespace {

constexpr std::size_t kTexels =
    std::size_t{ImperfectShadowMaps::kEdge} * ImperfectShadowMaps::kEdge;
/// A point casts its shadow this much of its distance, and of its radius, behind itself.
constexpr float kBias = 0.05f;

/// The place in the map, [0, kEdge]^2, of a direction in the light's basis: a paraboloid parts the
/// hemisphere into texels of about equal solid angles.
V2f project(const V3f& direction) noexcept {
    const float scale = 0.5f * ImperfectShadowMaps::kEdge / (1.0f + direction.z);
    constexpr float kMiddle = 0.5f * ImperfectShadowMaps::kEdge;
    return {kMiddle + direction.x * scale, kMiddle + direction.y * scale};
}

std::size_t texel(float t) noexcept {
    return static_cast<std::size_t>(
        std::clamp(t, 0.0f, static_cast<float>(ImperfectShadowMaps::kEdge - 1)));
}

/// One map, while it is drawn.
class Map {
  public:
    Map(const VirtualLight& light, float* depths)
        : position_(light.position), basis_(light.normal), depths_(depths) {
        std::fill_n(depths_, kTexels, std::numeric_limits<float>::infinity());
    }

    void splat(const CloudPoint& point) noexcept {
        const V3f way = point.position - position_;
        const float distance = way.length();
        const V3f direction = basis_.to_local(way) / distance;
        if (!(direction.z > 0.0f)) return;
        const V2f place = project(direction);
        // A disk turned away looks narrower; as a circle of the same area it has no direction.
        const float facing = std::fabs(point.normal.dot(way)) / distance;
        const float angle = std::min(point.radius * std::sqrt(facing) / distance, 0.5f);
        const float reach = angle * 0.5f * ImperfectShadowMaps::kEdge / (1.0f + direction.z);
        const float depth = distance * (1.0f + kBias) + kBias * point.radius;
        for (std::size_t y = texel(place.y - reach); y <= texel(place.y + reach); ++y) {
            for (std::size_t x = texel(place.x - reach); x <= texel(place.x + reach); ++x) {
                float& nearest = depths_[y * ImperfectShadowMaps::kEdge + x];
                nearest = std::min(nearest, depth);
            }
        }
    }

  private:
    V3f position_;
    Basis basis_;
    float* depths_;
};

/// True if a point casts a shadow: Program 1 of [TH16].
bool casts(const CloudPoint& point, const VirtualLight& light, float range2) noexcept {
    const V3f way = point.position - light.position;
    return way.dot(point.normal) > 0.0f && way.dot(light.normal) > 0.0f && way.dot(way) < range2;
}

}  // namespace

ImperfectShadowMaps::ImperfectShadowMaps(const std::vector<VirtualLight>& lights,
                                         Span<const float> ranges, const PointCloud& cloud,
                                         std::uint64_t key)
    : depths_(new float[lights.size() * kTexels]) {  // not set here: each map is set where it is
                                                     // drawn
    std::vector<std::uint64_t> splatted(lights.size(), 0);
    for_each_block(lights.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Map map(lights[i], depths_.get() + i * kTexels);
            if (cloud.part_count() == 0) continue;
            const float range2 = ranges[i] * ranges[i];
            const std::size_t part = hash(key, i) % cloud.part_count();
            cloud.for_near(part, lights[i].position, ranges[i], [&](const CloudPoint& point) {
                if (!casts(point, lights[i], range2)) return;
                map.splat(point);
                ++splatted[i];
            });
        }
    });
    for (const std::uint64_t n : splatted) splatted_ += n;
}

bool ImperfectShadowMaps::occluded(std::size_t i, const VirtualLight& light,
                                   const V3f& place) const noexcept {
    const V3f way = place - light.position;
    const float distance = way.length();
    const V3f direction = Basis(light.normal).to_local(way) / distance;
    if (!(direction.z > 0.0f)) return false;
    const V2f at = project(direction);
    return depths_[i * kTexels + texel(at.y) * kEdge + texel(at.x)] < distance;
}

}  // namespace lightcull
