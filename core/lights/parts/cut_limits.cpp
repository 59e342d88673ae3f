#include <lightcull/triangle_cuts.h>

#include <algorithm>
#include <functional>
#include <numeric>

namespace lightcull {
namespace {

/// Lights that cuts may add to a scene: so many, or such a part of those that there are.
constexpr std::size_t kMostAdded = 4096;
constexpr std::size_t kMostAddedPart = 4;

/// The part of what all lights emit, but for the brightest, from which on a light is worth a cut.
constexpr double kLeastPart = 1.0 / 1024.0;
constexpr std::size_t kBrightest = 16;
constexpr std::size_t kBrightestPart = 256;

double least_flux(Span<const Light> lights) {
    std::vector<float> intensities;
    for (const Light& light : lights) {
        if (!light.directional) intensities.push_back(light.intensity);
    }
    const std::size_t apart = kBrightest + intensities.size() / kBrightestPart;
    if (intensities.size() <= apart) return 0.0;
    const auto others = intensities.begin() + static_cast<std::ptrdiff_t>(apart);
    std::nth_element(intensities.begin(), others, intensities.end(), std::greater<>());
    return kLeastPart * std::accumulate(others, intensities.end(), 0.0);
}

}  // namespace

CutLimits cut_limits(Span<const Light> lights) {
    return {least_flux(lights), std::max(kMostAdded, lights.size() / kMostAddedPart)};
}

}  // namespace lightcull
