#pragma once

#include "base/core_export.h"
#include "base/memory_size.h"
#include "render/vec.h"

#include <lightcull/span.h>

#include <ImathVec.h>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightcull {

/// Sums of whole passes, in double so that none is lost to rounding.
class LIGHTCULL_CORE_EXPORT Film {
  public:
    explicit Film(std::size_t pixels) : sums_(pixels, Imath::V3d(0.0)) {}

    /// Adds one sample per pixel.
    void add(const std::vector<V3f>& pass);
    /// The mean of the samples, black where there is none.
    std::vector<float3> mean() const;
    /// The mean of the samples without those of a film of the same passes, which are part of them.
    std::vector<float3> mean_without(const Film& part) const;

    /// The sums of the passes, three numbers per pixel, and the way to go on from them.
    const std::vector<Imath::V3d>& sums() const noexcept { return sums_; }
    void restore(Span<const double> sums, std::uint64_t passes) noexcept;

    /// The memory that the film takes, bytes.
    std::size_t memory_size() const noexcept { return size_of(sums_); }

  private:
    std::vector<Imath::V3d> sums_;
    std::uint64_t passes_ = 0;
};

}  // namespace lightcull
