#include "render/texture_mean.h"

#include "render/texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lightcull {
namespace {

using Imath::V2d;

/// Texels between two sums that are kept.
constexpr std::int64_t kStride = 8;

/// The most pieces of an edge. Edges that cross more texels, over many repeats of a texture, are
/// cut evenly; the number is a prime, so that the cuts do not keep step with the texels.
constexpr int kMostPieces = 65521;

/// Beyond this many texels from the origin, which texel it is means little.
constexpr double kFarthest = 0x1p40;

std::int64_t floor_of(double x) noexcept {
    return static_cast<std::int64_t>(std::floor(x));
}

std::int64_t wrap(std::int64_t i, std::int64_t size) noexcept {
    i %= size;
    return i < 0 ? i + size : i;
}

double cross(const V2d& a, const V2d& b) noexcept {
    return a.x * b.y - a.y * b.x;
}

/// The lines x = whole number (or y) that a way crosses, in the order in which it does.
class Crossings {
  public:
    Crossings(double from, double way)
        : from_(from),
          way_(way),
          line_(way > 0.0 ? std::floor(from) + 1.0 : std::ceil(from) - 1.0) {}

    /// The part of the way up to the next line; above 1 if there is none.
    double next() const noexcept { return way_ == 0.0 ? 2.0 : (line_ - from_) / way_; }
    void advance() noexcept { line_ += way_ > 0.0 ? 1.0 : -1.0; }

  private:
    double from_, way_, line_;
};

/// Calls add(begin, end) with the parts of a way that lie between lines.
template <typename Add>
void for_each_piece(const V2d& from, const V2d& way, const Add& add) {
    if (std::fabs(way.x) + std::fabs(way.y) > kMostPieces) {
        for (int i = 0; i < kMostPieces; ++i) {
            add(static_cast<double>(i) / kMostPieces, static_cast<double>(i + 1) / kMostPieces);
        }
        return;
    }
    Crossings x(from.x, way.x), y(from.y, way.y);
    double begin = 0.0;
    while (begin < 1.0) {
        Crossings& nearest = x.next() < y.next() ? x : y;
        const double end = std::min(nearest.next(), 1.0);
        nearest.advance();
        if (end > begin) add(begin, end);
        begin = std::max(begin, end);
    }
}

/// The integral of f(place, t) over t from 0 to 1, the part of the way to the place. It is exact
/// where f is a cubic between the lines.
template <typename Function>
double integral_along(const V2d& from, const V2d& to, const Function& f) {
    const V2d way = to - from;
    double sum = 0.0;
    for_each_piece(from, way, [&](double begin, double end) {
        // Gauss's two nodes.
        const double middle = 0.5 * (begin + end), off = (end - begin) * 0.28867513459481288;
        sum += 0.5 * (end - begin) *
               (f(from + way * (middle - off), middle - off) +
                f(from + way * (middle + off), middle + off));
    });
    return sum;
}

}  // namespace

TextureMean::TextureMean(const Texture& texture, Of of)
    : texture_(&texture),
      of_(of),
      width_(texture.width),
      height_(texture.height),
      sums_per_row_((width_ + kStride - 1) / kStride + 1) {
    sums_.reserve(static_cast<std::size_t>(sums_per_row_ * height_));
    for (std::int64_t y = 0; y < height_; ++y) {
        Sum sum;
        for (std::int64_t x = 0; x < width_; ++x) {
            if (x % kStride == 0) sums_.push_back(sum);
            sum.add(texel(x, y));
        }
        sums_.push_back(sum);
        total_ += sum.luminance;
    }
}

float TextureMean::over(const V2f& a, const V2f& b, const V2f& c) const noexcept {
    const Place place = place_of(a, b, c);
    if (place.is_far) return static_cast<float>(mean_of(place.touched));
    if (!any_lit(place.touched)) return 0.0f;
    const auto mean = static_cast<float>(mean_over(place));
    return mean > 0.0f ? mean : static_cast<float>(mean_of(place.touched));
}

float TextureMean::over_part(const V2f& a, const V2f& b, const V2f& c) const noexcept {
    const Place place = place_of(a, b, c);
    if (place.is_far || !place.has_area) return over(a, b, c);
    if (!any_lit(place.touched)) return 0.0f;
    constexpr double kRounding = 0x1p-40;
    const double mean = mean_over(place);
    const double area = 0.5 * std::fabs(cross(place.b - place.a, place.c - place.a));
    return mean * area > kRounding * total_ ? static_cast<float>(mean) : 0.0f;
}

TextureMean::Place TextureMean::place_of(const V2f& a, const V2f& b, const V2f& c) const noexcept {
    V2d pa = to_texels(a), pb = to_texels(b), pc = to_texels(c);
    const V2d low(std::min({pa.x, pb.x, pc.x}), std::min({pa.y, pb.y, pc.y}));
    const V2d high(std::max({pa.x, pb.x, pc.x}), std::max({pa.y, pb.y, pc.y}));
    const double farthest =
        std::max({std::fabs(low.x), std::fabs(low.y), std::fabs(high.x), std::fabs(high.y)});
    if (!(farthest < kFarthest)) return {pa, pb, pc, {0, 0, width_, height_}, true, false};

    // Near the origin sums are small, and lose little by rounding.
    const V2d nearer(
        std::floor(low.x / static_cast<double>(width_)) * static_cast<double>(width_),
        std::floor(low.y / static_cast<double>(height_)) * static_cast<double>(height_));
    for (V2d* corner : {&pa, &pb, &pc}) *corner -= nearer;
    // Of a sliver less than 1e-8 of its length wide, rounding would leave little.
    const double extent = std::max(high.x - low.x, high.y - low.y);
    const bool has_area = std::fabs(cross(pb - pa, pc - pa)) > 1e-8 * extent * (extent + 1.0);
    return {pa, pb, pc, touched(low, high), false, has_area};
}

double TextureMean::mean_over(const Place& place) const noexcept {
    return place.has_area ? mean_over_area(place.a, place.b, place.c)
                          : mean_over_line(place.a, place.b, place.c);
}

V2d TextureMean::to_texels(const V2f& uv) const noexcept {
    return {static_cast<double>(uv.x) * static_cast<double>(width_) - 0.5,
            (1.0 - static_cast<double>(uv.y)) * static_cast<double>(height_) - 0.5};
}

TextureMean::Texels TextureMean::touched(const V2d& low, const V2d& high) const noexcept {
    // lookup() in floats may touch a texel more.
    const V2d slack(0x1p-22 * (std::max(std::fabs(low.x), std::fabs(high.x)) + 1.0),
                    0x1p-22 * (std::max(std::fabs(low.y), std::fabs(high.y)) + 1.0));
    const V2d first = low - slack, last = high + slack;
    return {floor_of(first.x), floor_of(first.y),
            std::min(floor_of(last.x) - floor_of(first.x) + 2, width_),
            std::min(floor_of(last.y) - floor_of(first.y) + 2, height_)};
}

double TextureMean::texel(std::int64_t x, std::int64_t y) const noexcept {
    const V3f rgb =
        lightcull::texel(*texture_, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
    const auto value = static_cast<double>(luminance(rgb));
    return of_ == Of::kSquare ? value * value : value;
}

void TextureMean::Sum::add(double texel) noexcept {
    luminance += texel;
    lit += texel > 0.0 ? 1 : 0;
}

TextureMean::Sum TextureMean::sum_of_first(std::int64_t row, std::int64_t count) const noexcept {
    const std::int64_t kept = count == width_ ? sums_per_row_ - 1 : count / kStride;
    Sum sum = sums_[static_cast<std::size_t>(row * sums_per_row_ + kept)];
    for (std::int64_t x = kept * kStride; x < count; ++x) sum.add(texel(x, row));
    return sum;
}

struct TextureMean::Cell {
    std::int64_t x, y;
    double texels[2][2];  ///< texels of its corners, by row
    double integrals[2];  ///< integrals of lookup() along the rows' middles, up to the cell

    bool has(const V2d& place) const noexcept {
        return floor_of(place.x) == x && floor_of(place.y) == y;
    }
    double lookup(const V2d& place) const noexcept {
        const double s = place.x - static_cast<double>(x), t = place.y - static_cast<double>(y);
        return (texels[0][0] + s * (texels[0][1] - texels[0][0])) * (1.0 - t) +
               (texels[1][0] + s * (texels[1][1] - texels[1][0])) * t;
    }
    /// The integral of lookup() along x, up to a place.
    double integral(const V2d& place) const noexcept {
        const double s = place.x - static_cast<double>(x), t = place.y - static_cast<double>(y);
        const auto of_row = [&](int row) {
            const double first = texels[row][0], second = texels[row][1];
            return integrals[row] + s * (first + 0.5 * s * (second - first));
        };
        return of_row(0) * (1.0 - t) + of_row(1) * t;
    }
};

TextureMean::Cell TextureMean::cell_at(const V2d& place) const noexcept {
    Cell cell{floor_of(place.x), floor_of(place.y), {}, {}};
    const std::int64_t column = wrap(cell.x, width_), next = wrap(column + 1, width_);
    const std::int64_t repeats = (cell.x - column) / width_;
    for (int j = 0; j < 2; ++j) {
        const std::int64_t row = wrap(cell.y + j, height_);
        cell.texels[j][0] = texel(column, row);
        cell.texels[j][1] = texel(next, row);
        // The trapezoids of whole repeats and of the cells before, but for half of the first texel:
        // a number of the row alone, which the edges of a triangle cancel.
        cell.integrals[j] = static_cast<double>(repeats) * sum_of_first(row, width_).luminance +
                            sum_of_first(row, column).luminance + 0.5 * cell.texels[j][0];
    }
    return cell;
}

double TextureMean::mean_over_area(const V2d& a, const V2d& b, const V2d& c) const noexcept {
    Cell cell = cell_at(a);
    const auto edge = [&](const V2d& from, const V2d& to) {
        if (from.y == to.y) return 0.0;
        return (to.y - from.y) * integral_along(from, to, [&](const V2d& place, double) {
                   if (!cell.has(place)) cell = cell_at(place);
                   return cell.integral(place);
               });
    };
    return 2.0 * (edge(a, b) + edge(b, c) + edge(c, a)) / cross(b - a, c - a);
}

/// The mean over a triangle that is only a line in texture space. b becomes the corner between the
/// others: a place there stands for the longest line of the triangle, a and c for none.
double TextureMean::mean_over_line(V2d a, V2d b, V2d c) const noexcept {
    const auto length2 = [](const V2d& from, const V2d& to) { return (to - from).length2(); };
    if (length2(a, b) > std::max(length2(a, c), length2(b, c))) {
        std::swap(b, c);
    } else if (length2(b, c) > length2(a, c)) {
        std::swap(a, b);
    }
    const double first = (b - a).length(), second = (b - c).length();
    Cell cell = cell_at(a);
    if (!(first + second > 0.0)) return cell.lookup(a);
    const auto rising = [&](const V2d& place, double t) {
        if (!cell.has(place)) cell = cell_at(place);
        return cell.lookup(place) * t;
    };
    return 2.0 * (first * integral_along(a, b, rising) + second * integral_along(c, b, rising)) /
           (first + second);
}

bool TextureMean::any_lit(const Texels& texels) const noexcept {
    const std::int64_t begin = wrap(texels.x, width_), end = begin + texels.columns;
    for (std::int64_t j = 0; j < texels.rows; ++j) {
        const std::int64_t row = wrap(texels.y + j, height_);
        const std::int64_t wrapped = end > width_ ? sum_of_first(row, end - width_).lit : 0;
        const std::int64_t lit =
            sum_of_first(row, std::min(end, width_)).lit - sum_of_first(row, begin).lit;
        if (lit + wrapped > 0) {
            return true;
        }
    }
    return false;
}

double TextureMean::mean_of(const Texels& texels) const noexcept {
    double sum = 0.0;
    for (std::int64_t j = 0; j < texels.rows; ++j) {
        const std::int64_t row = wrap(texels.y + j, height_);
        for (std::int64_t i = 0; i < texels.columns; ++i) {
            sum += texel(wrap(texels.x + i, width_), row);
        }
    }
    return sum / (static_cast<double>(texels.rows) * static_cast<double>(texels.columns));
}

}  // namespace lightcull
