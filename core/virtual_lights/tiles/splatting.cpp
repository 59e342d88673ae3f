#include "virtual_lights/tiles/splatting.h"

#include "base/parallel_blocks.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lightcull {
namespace {

/// The number of rows of pixels that one task lights.
constexpr std::uint32_t kBand = 16;

/// A rectangle of columns and rows of pixels; the ends are outside.
struct Rectangle {
    std::uint32_t x0, x1, y0, y1;
};

/// The rows, or columns, of an image, by the tangents at which they show anything.
class Lines {
  public:
    explicit Lines(std::uint32_t count)
        : low_(count, std::numeric_limits<float>::infinity()), high_(count, -low_.front()) {}

    void add(std::uint32_t line, float tangent) noexcept {
        low_[line] = std::min(low_[line], tangent);
        high_[line] = std::max(high_[line], tangent);
    }
    /// Makes both bounds grow from line to line. It is called after all add().
    void finish() {
        for (std::size_t i = 1; i < high_.size(); ++i) high_[i] = std::max(high_[i], high_[i - 1]);
        for (std::size_t i = low_.size() - 1; i-- > 0;) low_[i] = std::min(low_[i], low_[i + 1]);
    }
    /// The first line, and the one behind the last, that show something between two tangents.
    std::pair<std::uint32_t, std::uint32_t> between(float from, float to) const noexcept {
        const auto first = std::lower_bound(high_.begin(), high_.end(), from) - high_.begin();
        const auto end = std::upper_bound(low_.begin(), low_.end(), to) - low_.begin();
        return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end)};
    }

  private:
    std::vector<float> low_, high_;
};

/// Finds rectangles from the places that the pixels show.
class Screen {
  public:
    explicit Screen(const CameraView& view) : columns_(view.width), rows_(view.height) {
        for (std::uint32_t y = 0; y < view.height; ++y) {
            for (std::uint32_t x = 0; x < view.width; ++x) {
                if (view.hit[view.index(x, y)] == 0) continue;
                const V3f& place = view.view_positions[view.index(x, y)];
                columns_.add(x, place.x / place.z);
                rows_.add(y, -place.y / place.z);
            }
        }
        columns_.finish();
        rows_.finish();
        all_ = {0, view.width, 0, view.height};
    }

    Rectangle around(const AlignedBox& box) const noexcept {
        if (!(box.high.z > 0.0f)) return {0, 0, 0, 0};
        if (!(box.low.z > 0.0f)) return all_;
        const auto least = [&](float t) { return t / (t < 0.0f ? box.low.z : box.high.z); };
        const auto most = [&](float t) { return t / (t < 0.0f ? box.high.z : box.low.z); };
        const auto [x0, x1] = columns_.between(least(box.low.x), most(box.high.x));
        const auto [y0, y1] = rows_.between(least(-box.high.y), most(-box.low.y));
        return {x0, x1, y0, y1};
    }

  private:
    Lines columns_, rows_;
    Rectangle all_{};
};

/// The first number from `from` on that leaves `rest` when divided by `step`.
std::uint32_t first_from(std::uint32_t from, std::uint32_t rest, std::uint32_t step) noexcept {
    return from + (rest + step - from % step) % step;
}

/// Lights bands of rows.
class Splatting {
  public:
    Splatting(const PassLights& lights, Span<V3f> pixels)
        : of_pass_(lights),
          lights_(lights.lights),
          step_(lights.pass.options.interleave),
          pixels_(pixels),
          rectangles_(lights_.all().size()),
          places_(lights_.subsets()) {
        const Screen screen(lights.pass.view);
        for_each_block(rectangles_.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                rectangles_[i] = screen.around(lights_.box(i));
            }
        });
        for (std::uint32_t i = 0; i < lights_.subsets(); ++i) {
            places_[lights.subset_of(i % step_, i / step_)] = {i % step_, i / step_};
        }
    }

    LightingCounts light_band(std::uint32_t top) const {
        PixelLighting lighting(of_pass_, pixels_);
        for (std::uint32_t subset = 0; subset < lights_.subsets(); ++subset) {
            for (std::size_t i = lights_.begin(subset); i < lights_.begin(subset + 1); ++i) {
                Rectangle part = rectangles_[i];
                part.y0 = std::max(part.y0, top);
                part.y1 = std::min(part.y1, top + kBand);
                splat(i, part, places_[subset], lighting);
            }
        }
        return lighting.counts();
    }

  private:
    void splat(std::size_t light, const Rectangle& part,
               const std::pair<std::uint32_t, std::uint32_t>& place,
               PixelLighting& lighting) const {
        const CameraView& view = of_pass_.pass.view;
        for (std::uint32_t y = first_from(part.y0, place.second, step_); y < part.y1; y += step_) {
            for (std::uint32_t x = first_from(part.x0, place.first, step_); x < part.x1;
                 x += step_) {
                const std::size_t pixel = view.index(x, y);
                if (view.hit[pixel] == 0) continue;
                lighting.count(pixel, 1);
                lighting.add(pixel, lights_.listed(light));
            }
        }
    }

    const PassLights& of_pass_;
    const PreparedLights& lights_;
    std::uint32_t step_;
    Span<V3f> pixels_;
    std::vector<Rectangle> rectangles_;  // rectangles, by light
    std::vector<std::pair<std::uint32_t, std::uint32_t>>
        places_;  // places of a subset's pixels in a square
};

}  // namespace

LightingCounts splat_lights(const PassLights& lights, Span<V3f> pixels) {
    const Splatting splatting(lights, pixels);
    const std::uint32_t height = lights.pass.view.height;
    std::vector<LightingCounts> counts((height + kBand - 1) / kBand);
    for_each_block(counts.size(), 1, [&](std::size_t band, std::size_t) {
        if (lights.pass.cancelled()) return;
        counts[band] = splatting.light_band(static_cast<std::uint32_t>(band) * kBand);
    });
    LightingCounts sum;
    for (const LightingCounts& c : counts) sum += c;
    return sum;
}

}  // namespace lightcull
