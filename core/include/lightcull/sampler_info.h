#pragma once

#include <lightcull/export.h>
#include <lightcull/light_sampler.h>

#include <cstddef>
#include <cstdint>
#include <limits>

namespace lightcull {

/// The cost of one selection, counted by a second, slower run of it.
struct SelectionCounts {
    std::uint32_t nodes_visited = 0;  ///< tree nodes that were read
    std::uint32_t lights_tested = 0;  ///< lights whose range or importance was computed
    std::uint32_t accepted = 0;       ///< lights that were weighed with a weight above 0
};

/// The costs of a sampler, and what it has learned, for benchmarks and reports. Const calls may run
/// on any number of threads.
class LIGHTCULL_EXPORT SamplerInfo {
  public:
    /// The cost of select() at a point.
    virtual SelectionCounts count(const ShadingPoint& point) const noexcept = 0;

    /// The memory that the sampler keeps, bytes; for a pass with all that it shares.
    virtual std::size_t memory_size() const noexcept = 0;

    /// The most that memory_size() may become: more than it is where a sampler learns.
    virtual std::size_t memory_limit() const noexcept { return memory_size(); }

    /// The number of cells of what was learned; 0 if nothing was.
    virtual std::size_t cell_count() const noexcept { return 0; }

    /// The part of memory_size() that cells take, bytes.
    virtual std::size_t cell_memory_size() const noexcept { return 0; }

    /// True as long as a pass to come may select otherwise for what is reported. Once it is false,
    /// samplers that know the same (LightSampler::learned) may render passes in any order.
    virtual bool learning() const noexcept { return false; }

    static constexpr std::uint32_t kNoCell = 0xffffffffu;

    /// The cell that a point lies in, below cell_count(); kNoCell if it lies in none. select()
    /// chooses by this one or, so that no edges are seen, by one that is near.
    virtual std::uint32_t cell_of(const ShadingPoint& /*point*/) const noexcept { return kNoCell; }

    /// V, the share of shadow rays that is taken to arrive, from the cell that a point lies in, at
    /// the lights of the cluster that holds `light`: [0, 1]. It is the square of the factor by
    /// which select() weighs the cluster, and so is not below the square of the least factor there
    /// is. Not a number if the point lies in no cell, if no ray of the cell has gone to the cluster
    /// yet, or if the cluster gives the point no light.
    virtual float learned_visibility(const ShadingPoint& /*point*/,
                                     std::uint32_t /*light*/) const noexcept {
        return std::numeric_limits<float>::quiet_NaN();
    }

  protected:
    ~SamplerInfo() = default;
};

/// The costs of a sampler or a pass, which must outlive the answer; null for a host's own sampler
/// that has none.
LIGHTCULL_EXPORT const SamplerInfo* sampler_info(const LightSelector& sampler) noexcept;

}  // namespace lightcull
