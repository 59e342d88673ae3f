#pragma once

#include <lightcull/span.h>
#include <lightcull/triangle_cuts.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mitsuba::culling {

/// The radiance of a triangle at the middles and the corners of the size^2 equal triangles that
/// lines along its edges make of it, and means of it over parts.
class EmissionLattice {
  public:
    /// Middle (column, row) of size^2 has the barycentric coordinates column + kOffset and row +
    /// kOffset, over size; where the sum of column and row is `size` or more, one minus them.
    static constexpr float kOffset = 1.0f / 3.0f;

    /// How many radiances (luminance, >= 0) a lattice is made from: those of the size^2 middles,
    /// row by row, and of the (size + 1)^2 corners, of which those beyond the triangle mean
    /// nothing.
    static std::size_t count(std::uint32_t size) {
        const std::size_t edge = size;
        return edge * edge + (edge + 1) * (edge + 1);
    }

    /// A part counts as having `least` of the triangle's mean at least, where the lattice may miss
    /// what emits.
    EmissionLattice(std::uint32_t size, ::lightcull::Span<const float> radiances, float least)
        : size_(size), corners_(radiances.begin() + std::size_t{size} * size, radiances.end()) {
        sums_.resize(2 * std::size_t{size_} * (size_ + 1));
        for (std::uint32_t line = 0; line < 2 * size_; ++line) {
            Sum* const sums = of_line(line);
            for (std::uint32_t i = 0; i < count_of(line); ++i) {
                const auto radiance = static_cast<double>(radiances[index_of(line, i)]);
                sums[i + 1] = {sums[i].radiance + radiance, sums[i].square + radiance * radiance};
            }
            total_ += sums[count_of(line)].radiance;
        }
        is_smooth_ = is_smooth();
        least_ = static_cast<double>(least) * total_ / (static_cast<double>(size_) * size_);
    }

    /// What a part emits.
    ::lightcull::PartEmission over(const ::lightcull::SubTriangle& part) const {
        ::lightcull::PartEmission emission;
        if (!(total_ > 0.0)) return emission;
        const auto [a, b, c] = part.corners;
        const double low = std::min({a.y, b.y, c.y}), high = std::max({a.y, b.y, c.y});
        const auto first = static_cast<std::uint32_t>(2.0 * std::max(std::floor(low * size_), 0.0));
        Sum sum{0.0, 0.0};
        double count = 0.0;
        for (std::uint32_t line = first; line < 2 * size_ && height_of(line) <= high; ++line) {
            const auto [from, to] = within(part, line);
            if (from >= to) continue;
            const Sum* const sums = of_line(line);
            sum.radiance += sums[to].radiance - sums[from].radiance;
            sum.square += sums[to].square - sums[from].square;
            count += to - from;
        }
        if (count == 0.0) {
            sum.radiance = nearest({(a.x + b.x + c.x) / 3.0f, (a.y + b.y + c.y) / 3.0f});
            sum.square = sum.radiance * sum.radiance;
            count = 1.0;
        }
        const double mean = std::max(sum.radiance / count, least_);
        emission.mean = static_cast<float>(mean);
        if (!(mean > 0.0)) return emission;
        const double unevenness = std::max(sum.square / count / (mean * mean) - 1.0, 0.0);
        emission.unevenness = static_cast<float>(unevenness);
        look_at_corners(part, emission);
        return emission;
    }

  private:
    struct Sum {
        double radiance, square;
    };
    struct Range {
        std::uint32_t from, to;
    };

    // Middles lie on 2 * size lines along the first edge: even ones are of triangles that lie as
    // the whole does, odd ones of those between them, which are upside down.
    std::uint32_t count_of(std::uint32_t line) const { return size_ - line / 2 - line % 2; }
    double offset_of(std::uint32_t line) const { return (1.0 + line % 2) / 3.0; }
    double height_of(std::uint32_t line) const {
        const std::uint32_t row = line / 2;
        return (row + offset_of(line)) / size_;
    }
    std::size_t index_of(std::uint32_t line, std::uint32_t i) const {
        const std::size_t row = line / 2;
        return line % 2 == 0 ? row * size_ + i : (size_ - 1 - row) * size_ + (size_ - 1 - i);
    }
    Sum* of_line(std::uint32_t line) { return &sums_[std::size_t{line} * (size_ + 1)]; }
    const Sum* of_line(std::uint32_t line) const { return &sums_[std::size_t{line} * (size_ + 1)]; }

    /// Corrects what a few middles say of a small part, where the radiance is smooth, by what it is
    /// at the corners and between them: such a part has a linear density.
    void look_at_corners(const ::lightcull::SubTriangle& part,
                         ::lightcull::PartEmission& emission) const {
        constexpr float kFew = 9.0f;
        constexpr float kLeast = 0.05f;  // part of the sum
        const auto size = static_cast<float>(size_);
        if (!is_smooth_ || ::lightcull::area_share(part) * size * size > kFew) return;
        const auto& [a, b, c] = part.corners;
        float at[3], between[3];
        if (!corners_at({a, b, c}, at)) return;
        const float sum = at[0] + at[1] + at[2], least = kLeast * sum;
        float densities[3], mean = sum / 3.0f, squares = 1.0f;
        for (int i = 0; i < 3; ++i) densities[i] = std::max(at[i], least);
        if (corners_at({middle(a, b), middle(b, c), middle(c, a)}, between)) {
            // Exact if the radiance is quadratic.
            mean = (between[0] + between[1] + between[2]) / 3.0f;
            const float third = (densities[0] + densities[1] + densities[2]) / 3.0f;
            squares = 0.0f;
            for (int i = 0; i < 3 && third > 0.0f; ++i) {
                const float density = (densities[i] + densities[(i + 1) % 3]) / (2.0f * third);
                const float radiance = between[i] / mean;
                squares += radiance * radiance / (3.0f * density);
            }
        }
        if (!(sum > 0.0f) || mean < 0.5f * emission.mean) return;
        std::copy_n(densities, 3, emission.densities);
        emission.mean = mean;
        emission.unevenness = std::max(squares - 1.0f, 0.0f);
    }

    static ::lightcull::float2 middle(const ::lightcull::float2& a, const ::lightcull::float2& b) {
        return {0.5f * (a.x + b.x), 0.5f * (a.y + b.y)};
    }

    /// Whether the radiance is about linear in each of the lattice's triangles, as textures are
    /// that are interpolated: the middle is what the corners are on average.
    bool is_smooth() const {
        constexpr double kMost = 0.2;
        double off = 0.0, variation = 0.0;
        for (std::uint32_t line = 0; line < 2 * size_; ++line) {
            const Sum* const sums = of_line(line);
            const std::uint32_t row = line / 2, upper = line % 2;
            for (std::uint32_t i = 0; i < count_of(line); ++i) {
                const double a = upper == 0 ? corner(i, row) : corner(i + 1, row + 1);
                const double b = corner(i + 1, row), c = corner(i, row + 1);
                const double middle = sums[i + 1].radiance - sums[i].radiance;
                off += std::fabs(middle - (a + b + c) / 3.0);
                variation += std::max({a, b, c}) - std::min({a, b, c});
            }
        }
        return off <= kMost * variation;
    }

    double corner(std::uint32_t column, std::uint32_t row) const {
        return corners_[std::size_t{row} * (size_ + 1) + column];
    }

    /// The radiance at some places; false if they are not all corners of the lattice.
    bool corners_at(const ::lightcull::float2 (&places)[3], float (&at)[3]) const {
        for (int i = 0; i < 3; ++i) {
            const double x = static_cast<double>(places[i].x) * size_;
            const double y = static_cast<double>(places[i].y) * size_;
            if (x != std::floor(x) || y != std::floor(y)) return false;
            at[i] = static_cast<float>(
                corner(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)));
        }
        return true;
    }

    /// The middles of a line that lie in the part.
    Range within(const ::lightcull::SubTriangle& part, std::uint32_t line) const {
        const double y = height_of(line);
        double left = 1.0, right = 0.0;
        for (int i = 0; i < 3; ++i) {
            const ::lightcull::float2 p = part.corners[i], q = part.corners[(i + 1) % 3];
            const double from = p.y, to = q.y;
            if (std::min(from, to) > y || std::max(from, to) < y || from == to) continue;
            const double x = p.x + (y - from) / (to - from) * (static_cast<double>(q.x) - p.x);
            left = std::min(left, x);
            right = std::max(right, x);
        }
        const double from = std::ceil(left * size_ - offset_of(line));
        const double to = std::floor(right * size_ - offset_of(line)) + 1.0;
        const double most = count_of(line);
        if (!(from < to)) return {0, 0};
        return {static_cast<std::uint32_t>(std::clamp(from, 0.0, most)),
                static_cast<std::uint32_t>(std::clamp(to, 0.0, most))};
    }

    /// The radiance of the triangle that holds a place.
    double nearest(::lightcull::float2 place) const {
        const double x = place.x * static_cast<double>(size_);
        const double y = place.y * static_cast<double>(size_);
        const auto row = static_cast<std::uint32_t>(std::clamp(std::floor(y), 0.0, size_ - 1.0));
        const double column = std::clamp(std::floor(x), 0.0, size_ - 1.0 - row);
        const auto i = static_cast<std::uint32_t>(column);
        const bool between = x - column + y - row > 1.0 && i < count_of(2 * row + 1);
        const Sum* const sums = of_line(2 * row + (between ? 1 : 0));
        return sums[i + 1].radiance - sums[i].radiance;
    }

    std::uint32_t size_ = 0;
    std::vector<float> corners_;
    bool is_smooth_ = false;
    std::vector<Sum> sums_;  ///< sums of the middles of each line before one
    double total_ = 0.0, least_ = 0.0;
};

}  // namespace mitsuba::culling
