#include "render/environment.h"

#include "render/trigonometry.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lightcull {
namespace {

/// The mean of a bilinear lookup over a texel's cell: 1/8, 6/8, 1/8 in each direction; around the
/// sphere it wraps, at the poles it stops.
float mean_over_cell(const Texture& t, std::uint32_t x, std::uint32_t y) noexcept {
    const std::uint32_t columns[] = {(x + t.width - 1) % t.width, x, (x + 1) % t.width};
    const std::uint32_t rows[] = {y == 0 ? 0 : y - 1, y, std::min(y + 1, t.height - 1)};
    constexpr float kWeights[] = {0.125f, 0.75f, 0.125f};
    float sum = 0.0f;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
            const float3 texel = t.texels[std::size_t{rows[j]} * t.width + columns[i]];
            sum += kWeights[i] * kWeights[j] * luminance(to_v3f(texel));
        }
    }
    return sum;
}

/// The cosines of the angles to +Y at the edges of `rows` rows of cells. They are in double: next
/// to a pole those of a row differ by little.
std::vector<double> cosines_of_edges(std::uint32_t rows) {
    constexpr double kPiDouble = 3.14159265358979323846;
    std::vector<double> cosines;
    for (std::uint32_t row = 0; row <= rows; ++row) {
        cosines.push_back(std::cos(kPiDouble * row / rows));
    }
    return cosines;
}

}  // namespace

EnvironmentMap::EnvironmentMap(Environment environment)
    : map_(std::move(environment.map)),
      scale_(to_v3f(environment.scale)),
      cos_rotation_(std::cos(environment.rotation)),
      sin_rotation_(std::sin(environment.rotation)),
      pdfs_(map_.texels.size()),
      edge_cosines_(cosines_of_edges(map_.height)) {
    constexpr double kTwoPi = 6.28318530717958647692;
    std::vector<double> share(pdfs_.size());
    double total = 0.0;
    for (std::uint32_t y = 0; y < map_.height; ++y) {
        const double solid_angle = kTwoPi / map_.width * (edge_cosines_[y] - edge_cosines_[y + 1]);
        for (std::uint32_t x = 0; x < map_.width; ++x) {
            const std::size_t i = std::size_t{y} * map_.width + x;
            pdfs_[i] = mean_over_cell(map_, x, y);
            share[i] = static_cast<double>(pdfs_[i]) * solid_angle;
            total += share[i];
        }
    }
    if (!(total > 0.0)) return;
    cells_ = AliasTable(share);
    for (float& pdf : pdfs_) pdf = static_cast<float>(static_cast<double>(pdf) / total);
}

Environment EnvironmentMap::description() const {
    return {map_, to_float3(scale_), std::atan2(sin_rotation_, cos_rotation_)};
}

V2f EnvironmentMap::to_map(const V3f& d) const noexcept {
    const float x = cos_rotation_ * d.x - sin_rotation_ * d.z;
    const float z = sin_rotation_ * d.x + cos_rotation_ * d.z;
    const float across = 0.5f + static_cast<float>(arc_tangent(x, -z)) * (0.5f * kInvPi);
    // acos loses half of its digits at the poles.
    const float down = static_cast<float>(arc_tangent(std::sqrt(x * x + z * z), d.y)) * kInvPi;
    return {across * static_cast<float>(map_.width), down * static_cast<float>(map_.height)};
}

V3f EnvironmentMap::lookup(const V2f& place) const noexcept {
    const float x = place.x - 0.5f;
    const float y = std::clamp(place.y - 0.5f, 0.0f, static_cast<float>(map_.height - 1));
    const float left = std::floor(x);
    const auto column = static_cast<std::uint32_t>(left + static_cast<float>(map_.width));
    const std::uint32_t x0 = column % map_.width, x1 = (column + 1) % map_.width;
    const auto y0 = static_cast<std::uint32_t>(y);
    const std::uint32_t y1 = std::min(y0 + 1, map_.height - 1);
    const float fx = x - left, fy = y - static_cast<float>(y0);
    const auto texel = [&](std::uint32_t i, std::uint32_t j) {
        return to_v3f(map_.texels[std::size_t{j} * map_.width + i]);
    };
    const V3f top = texel(x0, y0) * (1.0f - fx) + texel(x1, y0) * fx;
    const V3f bottom = texel(x0, y1) * (1.0f - fx) + texel(x1, y1) * fx;
    return scale_ * (top * (1.0f - fy) + bottom * fy);
}

float EnvironmentMap::density(const V2f& place) const noexcept {
    const auto x = std::min(static_cast<std::uint32_t>(place.x), map_.width - 1);
    const auto y = std::min(static_cast<std::uint32_t>(place.y), map_.height - 1);
    return pdfs_[std::size_t{y} * map_.width + x];
}

EnvironmentValue EnvironmentMap::at(const V3f& direction) const noexcept {
    const V2f place = to_map(direction);
    return {lookup(place), cells_.empty() ? 0.0f : density(place)};
}

EnvironmentSample EnvironmentMap::sample(double cell, const V2f& u) const noexcept {
    if (cells_.empty()) return {};
    const std::uint32_t index = cells_.sample(cell);
    const std::uint32_t row = index / map_.width;
    const auto column = static_cast<float>(index % map_.width);

    // The direction is uniform per solid angle: uniform in the angle around +Y and in the cosine to
    // it.
    const float angle = 2.0f * kPi * ((column + u.x) / static_cast<float>(map_.width) - 0.5f);
    const auto [sine_around, cosine_around] = sine_cosine(0.25f * angle).doubled().doubled();
    const double top = edge_cosines_[row];
    const double y = top + (edge_cosines_[row + 1] - top) * static_cast<double>(u.y);
    const auto sine = static_cast<float>(std::sqrt(std::max(0.0, (1.0 - y) * (1.0 + y))));
    const float x = sine * sine_around, z = -sine * cosine_around;
    const V3f direction(cos_rotation_ * x + sin_rotation_ * z, static_cast<float>(y),
                        -sin_rotation_ * x + cos_rotation_ * z);
    // At a cell's edge rounding may put the direction into the next cell: take what is there.
    const EnvironmentValue value = at(direction);
    return {direction, value.radiance, value.pdf};
}

}  // namespace lightcull
