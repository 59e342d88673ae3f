#pragma once

#include "render/vec.h"

#include <ImathVec.h>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightcull {

/// Sums of whole passes, in double so that none is lost to rounding.
class Film {
  public:
    explicit Film(std::size_t pixels) : sums_(pixels, Imath::V3d(0.0)) {}

    /// Adds one sample per pixel.
    void add(const std::vector<V3f>& pass);
    /// The mean of the samples, black where there is none.
    std::vector<float3> mean() const;

  private:
    std::vector<Imath::V3d> sums_;
    std::uint64_t passes_ = 0;
};

}  // namespace lightcull
