#pragma once

#include "render/tiles.h"
#include "render/vec.h"

#include <lightcull/render/renderer.h>

#include <vector>

namespace lightcull {

/// Some pixels that are spread evenly over an image, an eighth of it at most, and what passes say
/// of the variance of a sample there.
class TrialImage {
  public:
    explicit TrialImage(const RenderSettings& settings);

    const std::vector<Tile>& tiles() const noexcept { return tiles_; }

    /// Takes the samples of a pass out of the pixels of the whole image, row 0 at the top, and
    /// leaves black there.
    void take(std::vector<V3f>& pixels) noexcept;

    /// The sum over pixels of the variance of a sample relative to the square of its mean, where
    /// that is not far below the mean of all.
    double relative_variance() const noexcept;

  private:
    std::uint32_t width_;
    std::vector<Tile> tiles_;
    std::vector<double> sums_, squares_;  ///< of the passes, by pixel
    int passes_ = 0;
};

}  // namespace lightcull
