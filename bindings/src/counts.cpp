#include "counts.h"

#include <algorithm>

namespace lightcull::python {

MeanCounts mean_counts(const LightSampler& sampler, Span<const ShadingPoint> points,
                       std::size_t count) {
    count = std::min(count, points.size());
    MeanCounts mean;
    for (std::size_t i = 0; i < count; ++i) {
        const SelectionCounts counts =
            sampler_info(sampler)->count(points[i * points.size() / count]);
        mean.nodes_visited += counts.nodes_visited;
        mean.lights_tested += counts.lights_tested;
        mean.accepted += counts.accepted;
    }
    const double n = std::max(static_cast<double>(count), 1.0);
    return {mean.nodes_visited / n, mean.lights_tested / n, mean.accepted / n};
}

}  // namespace lightcull::python
