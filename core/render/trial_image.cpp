#include "render/trial_image.h"

#include "base/random.h"

#include <algorithm>

namespace lightcull {

TrialImage::TrialImage(const RenderSettings& settings) : width_(settings.width) {
    constexpr std::uint32_t kEdge = 4, kMost = 64, kOneIn = 8;
    const std::vector<Tile> all = tiles_of({0, 0, settings.width, settings.height}, kEdge);
    const std::size_t count = std::clamp<std::size_t>(all.size() / kOneIn, 1, kMost);
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t begin = i * all.size() / count, end = (i + 1) * all.size() / count;
        const Tile& tile = all[begin + hash(i, std::uint64_t{end}) % (end - begin)];
        tiles_.push_back(tile);
        pixels += std::size_t{tile.x1 - tile.x0} * (tile.y1 - tile.y0);
    }
    sums_.resize(pixels);
    squares_.resize(pixels);
}

void TrialImage::take(std::vector<V3f>& pixels) noexcept {
    ++passes_;
    std::size_t i = 0;
    for (const Tile& tile : tiles_) {
        for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
            for (std::uint32_t x = tile.x0; x < tile.x1; ++x, ++i) {
                V3f& pixel = pixels[std::size_t{y} * width_ + x];
                const double value = double{pixel.x} + double{pixel.y} + double{pixel.z};
                sums_[i] += value;
                squares_[i] += value * value;
                pixel = V3f(0.0f);
            }
        }
    }
}

double TrialImage::relative_variance() const noexcept {
    constexpr double kDark = 0.05;
    double all = 0.0;
    for (const double sum : sums_) all += sum;
    const double dark = kDark * all / (passes_ * static_cast<double>(sums_.size()));
    if (!(dark > 0.0)) return 0.0;
    double variance = 0.0;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
        const double mean = sums_[i] / passes_;
        variance += (squares_[i] / passes_ - mean * mean) / (mean * mean + dark * dark);
    }
    return variance;
}

}  // namespace lightcull
