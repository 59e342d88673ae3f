#pragma once

#include <lightcull/light_sampler.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "gpu/breadth_first.h"
#include "gpu/buffer.h"
#include "gpu/chooser.h"
#include "gpu/kernel.h"

namespace lightcull {

/// A sampler on a device: the records of its scene as they lie, and what is done with them. All
/// calls throw Error where the device fails; it is then of no more use. It is for one thread at a
/// time.
class DeviceSampler {
  public:
    /// Ends a device's work: waits for it, as after a timeout the device may still be at some, but
    /// not for longer than the timeout. Memory that the device does not let go of by then is never
    /// freed.
    struct End {
        void operator()(DeviceSampler* sampler) const noexcept;
    };
    using Handle = std::unique_ptr<DeviceSampler, End>;

    /// Makes a sampler over a tree that is not empty.
    static Handle make(const Frame& frame, const RangeTree& tree, const Chooser& chooser,
                       const VulkanOptions& options);

    /// Computes the radii of all sets for the pass that the tree is in.
    void refit(const RandomRanges& ranges);

    /// Selects as the sampler does, but for the prob where a receipt's weight_sum is not above 0:
    /// there it only says, by being above 0, whether a light was found.
    void select(Span<const ShadingPoint> points, Span<const float> u, Span<Selection> selections);

    /// The radii, [set][node][slot], as RangeTree has them.
    std::vector<float> radii();

    /// The memory that is kept on the device, bytes.
    std::size_t memory_size() const noexcept;

  private:
    /// Makes room, and gives the device nothing to do.
    DeviceSampler(const Frame& frame, const RangeTree& tree, const Chooser& chooser,
                  const BreadthFirst& breadth_first, const VulkanOptions& options);

    /// Uploads the data for which the constructor has made room.
    void upload(const RangeTree& tree, const Chooser& chooser, const BreadthFirst& breadth_first);
    void write(const Buffer& buffer, Span<const std::byte> bytes);
    void read(const Buffer& buffer, Span<std::byte> bytes);

    /// Selects for at most kBatch points.
    void select_some(Span<const ShadingPoint> points, Span<const float> u,
                     Span<Selection> selections);

    Device device_;
    Frame frame_;
    float reach_;
    double timeout_seconds_;
    std::uint32_t set_count_, node_count_, level_count_, workgroup_;
    Buffer nodes_, order_, levels_, centers_, records_, turns_, leaves_, lights_;
    Buffer radii_, around_;
    Buffer points_, u_, selections_;
    Kernel refit_, select_;
    StagingBuffer staging_;
};

}  // namespace lightcull
