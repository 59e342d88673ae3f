#pragma once

#include <lightcull/export.h>
#include <lightcull/light_sampler.h>

#include <cstddef>
#include <cstdint>

namespace lightcull {

/// The cost of one selection, counted by a second, slower run of it.
struct SelectionCounts {
    std::uint32_t nodes_visited = 0;  ///< tree nodes that were read
    std::uint32_t lights_tested = 0;  ///< lights whose range or importance was computed
    std::uint32_t accepted = 0;       ///< lights that were weighed with a weight above 0
};

/// The costs of a sampler, for benchmarks and reports. Const calls may run on any number of
/// threads.
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

  protected:
    ~SamplerInfo() = default;
};

/// The costs of a sampler or a pass, which must outlive the answer; null for a host's own sampler
/// that has none.
LIGHTCULL_EXPORT const SamplerInfo* sampler_info(const LightSelector& sampler) noexcept;

}  // namespace lightcull
