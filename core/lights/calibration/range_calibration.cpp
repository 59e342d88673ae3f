#include "lights/calibration/range_calibration.h"

#include <lightcull/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/random.h"
#include "lights/light/importance.h"
#include "lights/ranges/ranges.h"

namespace lightcull {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kSampledLights = 8192, kDrawnPoints = 128;

// Ranges and their squares stay finite and above 0 for every xi and intensity.
constexpr double kLeastReach = 1e-30;

float clamp_reach(double reach) noexcept {
    return static_cast<float>(std::clamp(reach, kLeastReach, double{kGreatestReach}));
}

/// The reach by [TH16] Eq. 7, or appendix A, for the given epsilon_max.
double reach_of_error_bound(const RangedScene& scene, const RangeOptions& options, RangeLaw law) {
    const double error_bound = *options.error_bound, exposure = options.exposure;
    const double metres2 =
        law == RangeLaw::kRandom
            ? exposure / (2.0 * kPi * error_bound)
            : exposure * static_cast<double>(scene.lights.size()) / (kPi * error_bound);
    const double scale = scene.frame.inv_scale;
    return metres2 * scene.frame.intensity * scale * scale;
}

/// A random sample of the lights, where there are many.
std::vector<std::size_t> sample_lights(std::size_t n) {
    std::vector<std::size_t> sample(std::min(n, kSampledLights));
    for (std::size_t i = 0; i < sample.size(); ++i) {
        // One light of each stratum is drawn: neighbours in the array are often neighbours in
        // space.
        const std::size_t begin = i * n / sample.size(), end = (i + 1) * n / sample.size();
        sample[i] = begin + hash(i, 1) % (end - begin);
    }
    return sample;
}

/// The extent of a box for what lights of that extent light: a ceiling or a row of lights is flat,
/// and what it lights is not.
float3 not_flat(float3 extent) {
    constexpr float kOfLargest = 0.1f, kOfMiddle = 1.5f;
    std::array<float, 3> sorted{extent.x, extent.y, extent.z};
    std::sort(sorted.begin(), sorted.end());
    const float middle = std::max(sorted[1], kOfLargest * sorted[2]);
    const float least = kOfMiddle * middle;
    return max(extent, float3{least, least, least});
}

/// The caller's points, or some in a box about the lights that is not flat even if they are.
std::vector<Receiver> points_or_drawn(const RangedScene& scene, Span<const ShadingPoint> given) {
    std::vector<Receiver> points;
    for (const ShadingPoint& point : given) {
        points.emplace_back(scene.frame, point);
    }
    if (!points.empty()) return points;
    // Lights beyond that are far ones, as the frame has them.
    constexpr float kMost = 4.0f;
    float3 low{kMost, kMost, kMost}, high = low * -1.0f;
    for (const RangedLight& light : scene.lights) {
        const float3& p = light.center;
        if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > kMost) continue;
        low = min(low, p);
        high = max(high, p);
    }
    if (low.x > high.x) low = high = {0, 0, 0};  // All are far.
    RandomStream random(hash(2, 3));
    const float3 center = (low + high) * 0.5f;
    const float3 extent = not_flat(high - low);
    low = center - extent * 0.5f;
    for (std::size_t i = 0; i < kDrawnPoints; ++i) {
        const float x = random.next(), y = random.next(), z = random.next();
        points.emplace_back(low + float3{extent.x * x, extent.y * y, extent.z * z},
                            float3{0, 0, 0});
    }
    return points;
}

/// What a calibration looks at: for pairs of a point and a sampled light that can reach it the
/// distance to the bounding sphere, squared, over intensity, which is the reach at which p_i
/// becomes 1. The numbers ascend.
struct Thresholds {
    std::vector<float> sorted;
    std::size_t points = 0;  ///< number of points

    void add(const std::vector<float>& of_point) {
        sorted.insert(sorted.end(), of_point.begin(), of_point.end());
        ++points;
    }
};

/// The thresholds of the points that any light reaches. Points that lie within a light's sphere
/// count only if there are no others: mostly they lie on the lights themselves.
Thresholds thresholds_of(const RangedScene& scene, const std::vector<std::size_t>& sample,
                         const std::vector<Receiver>& points) {
    Thresholds outside, within;
    std::vector<float> of_point;
    for (const Receiver& point : points) {
        of_point.clear();
        for (const std::size_t i : sample) {
            const float distance = scene.distance(i, point);
            if (distance == RangedScene::kOutOfReach) continue;
            of_point.push_back(distance * distance / scene.lights[i].intensity);
        }
        if (of_point.empty()) continue;
        const bool is_within = *std::min_element(of_point.begin(), of_point.end()) == 0.0f;
        (is_within ? within : outside).add(of_point);
    }
    Thresholds& thresholds = outside.points > 0 ? outside : within;
    std::sort(thresholds.sorted.begin(), thresholds.sorted.end());
    return std::move(thresholds);
}

/// The sum over the thresholds t of p = min(1, reach / t), or of [t <= reach].
class ExpectedCount {
  public:
    ExpectedCount(std::vector<float> thresholds, RangeLaw law)
        : thresholds_(std::move(thresholds)), inverse_sums_(thresholds_.size() + 1, 0.0) {
        if (law == RangeLaw::kConstant) return;
        for (std::size_t i = thresholds_.size(); i-- > 0;) {
            inverse_sums_[i] = inverse_sums_[i + 1] + 1.0 / static_cast<double>(thresholds_[i]);
        }
    }
    double operator()(double reach) const noexcept {
        const auto above =
            std::upper_bound(thresholds_.begin(), thresholds_.end(), static_cast<float>(reach));
        const auto certain = static_cast<std::size_t>(above - thresholds_.begin());
        return static_cast<double>(certain) + reach * inverse_sums_[certain];
    }

  private:
    std::vector<float> thresholds_;
    std::vector<double> inverse_sums_;
};

RangedLight ranged(const LightRecord& light) noexcept {
    return {light.center, light.radius, light.intensity};
}

double reach_of_expected_count(const RangedScene& scene, const RangeOptions& options,
                               Span<const ShadingPoint> given, RangeLaw law) {
    const std::vector<std::size_t> sample = sample_lights(scene.lights.size());
    const std::vector<Receiver> points = points_or_drawn(scene, given);
    auto [thresholds, point_count] = thresholds_of(scene, sample, points);
    const double per_point = static_cast<double>(point_count) * static_cast<double>(sample.size()) /
                             static_cast<double>(scene.lights.size());
    // Lights that a point lies in are accepted whatever the reach; half of what is wanted is left
    // for the others at least.
    const auto always = static_cast<double>(
        std::upper_bound(thresholds.begin(), thresholds.end(), 0.0f) - thresholds.begin());
    const double expected = static_cast<double>(options.expected_accepted) * per_point;
    const double wanted = std::max(expected, always + 0.5 * expected);
    // Where there are fewer lights than wanted, all are reached.
    if (static_cast<double>(thresholds.size()) <= wanted) return kGreatestReach;
    const ExpectedCount count(std::move(thresholds), law);
    double low = std::log2(kLeastReach), high = std::log2(kGreatestReach);
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        (count(std::exp2(middle)) < wanted ? low : high) = middle;
    }
    return std::exp2(high);
}

void check_finite(Span<const ShadingPoint> points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const ShadingPoint& point = points[i];
        const GlossyLobe& lobe = point.lobe;
        if (!is_finite(point.position) || !is_finite(point.normal) || !is_finite(lobe.axis) ||
            !std::isfinite(point.diffuse) || !std::isfinite(lobe.alpha) ||
            !std::isfinite(lobe.peak)) {
            throw Error("calibration point " + std::to_string(i) + " is not finite");
        }
    }
}

}  // namespace

bool reaches(const LightRecord& light, const Approach& way, const Receiver& x) noexcept {
    return importance(light, way, Receiver(x.position, x.normal)) > 0.0f;
}

RangedScene ranged_scene(const LightTable& table) {
    RangedScene scene{table.frame, {}, [&table](std::size_t i, const Receiver& x) {
                          const LightRecord& light = table.records[table.lit[i]];
                          const Approach way = approach(x.position, light.center);
                          return reaches(light, way, x) ? ranged(light).distance(way)
                                                        : RangedScene::kOutOfReach;
                      }};
    scene.lights.reserve(table.lit.size());
    for (const std::uint32_t i : table.lit) scene.lights.push_back(ranged(table.records[i]));
    return scene;
}

float calibrate_reach(const RangedScene& scene, const RangeOptions& options,
                      Span<const ShadingPoint> points, RangeLaw law) {
    check_finite(points);
    if (scene.lights.empty()) return 1.0f;
    return clamp_reach(options.error_bound ? reach_of_error_bound(scene, options, law)
                                           : reach_of_expected_count(scene, options, points, law));
}

}  // namespace lightcull
