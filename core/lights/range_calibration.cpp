#include "lights/range_calibration.h"

#include <lightcull/error.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/random.h"
#include "lights/importance.h"
#include "lights/ranges.h"

namespace lightcull {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kSampledLights = 8192, kDrawnPoints = 128;

// Ranges and their squares stay finite and above 0 for every xi and intensity.
constexpr double kLeastReach = 1e-30, kGreatestReach = 1e18;

float clamp_reach(double reach) noexcept {
    return static_cast<float>(std::clamp(reach, kLeastReach, kGreatestReach));
}

void check(const RangeOptions& options) {
    const auto positive = [](float value, const char* name) {
        if (!(value > 0.0f && std::isfinite(value))) {
            throw Error(std::string(name) + " is " + std::to_string(value) +
                        ", wanted finite and above 0");
        }
    };
    if (options.error_bound) positive(*options.error_bound, "error_bound");
    positive(options.expected_accepted, "expected_accepted");
    positive(options.exposure, "exposure");
    for (std::size_t i = 0; i < options.calibration_points.size(); ++i) {
        const ShadingPoint& point = options.calibration_points[i];
        if (!is_finite(point.position) || !is_finite(point.normal)) {
            throw Error("calibration point " + std::to_string(i) + " is not finite");
        }
    }
}

/// [TH16] Eq. 7, or appendix A, for the given epsilon_max.
double reach_of_error_bound(const LightTable& table, const RangeOptions& options, RangeLaw law) {
    const double error_bound = *options.error_bound, exposure = options.exposure;
    const double metres2 =
        law == RangeLaw::kRandom
            ? exposure / (2.0 * kPi * error_bound)
            : exposure * static_cast<double>(table.lit.size()) / (kPi * error_bound);
    const double scale = table.frame.inv_scale;
    return metres2 * table.frame.intensity * scale * scale;
}

/// Every light of a small table; a random sample of a large one.
std::vector<std::uint32_t> sample_lights(const LightTable& table) {
    const std::size_t n = table.lit.size();
    if (n <= kSampledLights) return table.lit;
    std::vector<std::uint32_t> sample(kSampledLights);
    for (std::size_t i = 0; i < kSampledLights; ++i) {
        // One of each stratum: neighbours in the array are often neighbours in space.
        const std::size_t begin = i * n / kSampledLights, end = (i + 1) * n / kSampledLights;
        sample[i] = table.lit[begin + hash(i, 1) % (end - begin)];
    }
    return sample;
}

std::vector<ShadingPoint> points_or_drawn(const LightTable& table, const RangeOptions& options) {
    std::vector<ShadingPoint> points(options.calibration_points.begin(),
                                     options.calibration_points.end());
    for (ShadingPoint& point : points) point.position = table.frame.position(point.position);
    if (!points.empty()) return points;
    float3 low = table.records[table.lit[0]].center, high = low;
    for (const std::uint32_t i : table.lit) {
        low = min(low, table.records[i].center);
        high = max(high, table.records[i].center);
    }
    RandomStream random(hash(2, 3));
    const float3 extent = high - low;
    for (std::size_t i = 0; i < kDrawnPoints; ++i) {
        const float x = random.next(), y = random.next(), z = random.next();
        points.push_back({low + float3{extent.x * x, extent.y * y, extent.z * z}, {0, 0, 0}});
    }
    return points;
}

/// Distance to the bounding sphere, squared, over intensity, of all pairs of a point and a sampled
/// light that can reach it: the reach at which p_i becomes 1. Ascending.
std::vector<float> sorted_thresholds(const LightTable& table,
                                     const std::vector<std::uint32_t>& lights,
                                     const std::vector<ShadingPoint>& points) {
    std::vector<float> thresholds;
    thresholds.reserve(lights.size() * points.size());
    for (const ShadingPoint& point : points) {
        for (const std::uint32_t i : lights) {
            const LightRecord& light = table.records[i];
            const Approach way = approach(point.position, light.center);
            if (!(importance(light, way, Receiver(point)) > 0.0f)) continue;
            const float distance = distance_to_sphere(way.distance, light);
            thresholds.push_back(distance * distance / light.intensity);
        }
    }
    std::sort(thresholds.begin(), thresholds.end());
    return thresholds;
}

/// Sum over the thresholds t of p = min(1, reach / t), or of [t <= reach].
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

double reach_of_expected_count(const LightTable& table, const RangeOptions& options, RangeLaw law) {
    const std::vector<std::uint32_t> lights = sample_lights(table);
    const std::vector<ShadingPoint> points = points_or_drawn(table, options);
    std::vector<float> thresholds = sorted_thresholds(table, lights, points);
    const double wanted = static_cast<double>(options.expected_accepted) *
                          static_cast<double>(points.size()) * static_cast<double>(lights.size()) /
                          static_cast<double>(table.lit.size());
    // Fewer lights than wanted: reach them all.
    if (static_cast<double>(thresholds.size()) <= wanted) return kGreatestReach;
    const ExpectedCount count(std::move(thresholds), law);
    double low = std::log2(kLeastReach), high = std::log2(kGreatestReach);
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        (count(std::exp2(middle)) < wanted ? low : high) = middle;
    }
    return std::exp2(high);
}

}  // namespace

float calibrate_reach(const LightTable& table, const RangeOptions& options, RangeLaw law) {
    check(options);
    if (table.lit.empty()) return 1.0f;
    return clamp_reach(options.error_bound ? reach_of_error_bound(table, options, law)
                                           : reach_of_expected_count(table, options, law));
}

}  // namespace lightcull
