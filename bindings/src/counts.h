#pragma once

#include <lightcull/light_sampler.h>
#include <lightcull/sampler_info.h>
#include <lightcull/span.h>

#include <cstddef>

namespace lightcull::python {

/// The mean cost of one selection.
struct MeanCounts {
    double nodes_visited = 0.0, lights_tested = 0.0, accepted = 0.0;
};

/// The mean over `count` of the points, or all if they are fewer, spread evenly. 0 without points.
MeanCounts mean_counts(const LightSampler& sampler, Span<const ShadingPoint> points,
                       std::size_t count);

}  // namespace lightcull::python
