#pragma once

#include "base/core_export.h"
#include "render/vec.h"

#include <lightcull/render/scene.h>
#include <lightcull/span.h>

#include <cstdint>
#include <vector>

namespace lightcull {

/// The mean luminance of a texture over triangles in texture space (or that of its texels'
/// squares), exact whatever the size of the texture: by Green's theorem, the integral over a
/// triangle is one along its edges, of sums over the rows. A triangle costs time by the texels that
/// its edges cross, not by those inside.
class LIGHTCULL_CORE_EXPORT TextureMean {
  public:
    enum class Of { kLuminance, kSquare };

    /// The texture stays where it is. of: what of a texel the means are of.
    explicit TextureMean(const Texture& texture, Of of = Of::kLuminance);

    /// The mean of lookup(), of the luminances or their squares, over a triangle, or, for one
    /// without an area, over what it has become. It is 0 only where no lookup in the triangle can
    /// give anything else.
    float over(const V2f& a, const V2f& b, const V2f& c) const noexcept;

    /// The same of a part of a triangle. It is 0, too, where the part has so little of all that the
    /// texture holds that rounding may have made it.
    float over_part(const V2f& a, const V2f& b, const V2f& c) const noexcept;

  private:
    using V2d = Imath::V2d;

    /// A rectangle of texels, by their indices before repetition.
    struct Texels {
        std::int64_t x, y, columns, rows;
    };

    /// Coordinates in which the middle of the texel (x, y) lies at (x, y).
    V2d to_texels(const V2f& uv) const noexcept;
    /// The texels that lookups between two places can touch.
    Texels touched(const V2d& low, const V2d& high) const noexcept;
    double texel(std::int64_t x, std::int64_t y) const noexcept;

    struct Sum {
        double luminance = 0.0;
        std::int64_t lit = 0;  ///< number of texels above 0

        void add(double texel) noexcept;
    };
    /// The sum over the first `count` texels of a row.
    Sum sum_of_first(std::int64_t row, std::int64_t count) const noexcept;

    /// The square between the middles of four texels.
    struct Cell;
    Cell cell_at(const V2d& place) const noexcept;

    /// A triangle in texture space.
    struct Place {
        V2d a, b, c;
        Texels touched;
        bool is_far;  ///< too far from the origin to tell texels apart
        bool has_area;
    };
    Place place_of(const V2f& a, const V2f& b, const V2f& c) const noexcept;
    double mean_over(const Place& place) const noexcept;
    double mean_over_area(const V2d& a, const V2d& b, const V2d& c) const noexcept;
    double mean_over_line(V2d a, V2d b, V2d c) const noexcept;
    bool any_lit(const Texels& texels) const noexcept;
    double mean_of(const Texels& texels) const noexcept;

    const Texture* texture_;
    Of of_;
    std::int64_t width_, height_, sums_per_row_;
    double total_ = 0.0;     ///< sum over all texels
    std::vector<Sum> sums_;  ///< sums before every few texels of a row, and of all of it
};

}  // namespace lightcull
