#pragma once

#include <lightcull/light_sampler.h>

#include <cstddef>
#include <vector>

#include "gpu/breadth_first.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "lights/culled_scene.h"

namespace lightcull {

/// `culled` on a device: the records of a scene as they lie, and what is done with them. All calls
/// throw Error where the device fails; it is then of no more use. For one thread at a time.
class DeviceCulled {
  public:
    /// Of a scene that has any groups.
    DeviceCulled(const CulledScene& scene, const VulkanOptions& options);

    /// The radii of all sets for the pass that the scene's tree is in.
    void refit(const RandomRanges& ranges);

    /// As CulledSampler does, but for the prob where a receipt's weight_sum is not above 0: there
    /// it only says, by being above 0, whether a light was found.
    void select(Span<const ShadingPoint> points, Span<const float> u, Span<Selection> selections);

    /// [set][node][slot], as RangeTree has them.
    std::vector<float> radii();

    /// What is kept on the device, bytes.
    std::size_t memory_size() const noexcept;

  private:
    DeviceCulled(const CulledScene& scene, const BreadthFirst& breadth_first,
                 const VulkanOptions& options);

    /// At most kBatch points.
    void select_some(Span<const ShadingPoint> points, Span<const float> u,
                     Span<Selection> selections);

    Device device_;
    Frame frame_;
    float reach_;
    double timeout_seconds_;
    std::uint32_t set_count_, node_count_, level_count_;
    Buffer nodes_, order_, levels_, centers_, records_, ranks_, groups_, bvh_;
    Buffer radii_, around_;
    Buffer points_, u_, selections_;
    Kernel refit_, select_;
    StagingBuffer staging_;  // the last, so that its end waits before that of the others
};

}  // namespace lightcull
