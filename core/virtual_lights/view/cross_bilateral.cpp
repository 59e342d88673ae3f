#include "virtual_lights/view/cross_bilateral.h"

#include "base/parallel_blocks.h"
#include "virtual_lights/view/likeness.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lightcull {
namespace {

constexpr int kRadius = 8;

V3f reflectance(const Surface& surface) noexcept {
    constexpr float kLeast = 1e-3f;
    const V3f sum = surface.bsdf.diffuse_albedo() + surface.bsdf.f0();
    return {std::max(sum.x, kLeast), std::max(sum.y, kLeast), std::max(sum.z, kLeast)};
}

std::array<float, kRadius + 1> falloff() noexcept {
    std::array<float, kRadius + 1> weights{};
    for (int i = 0; i <= kRadius; ++i) {
        const float x = static_cast<float>(i) / (0.5f * kRadius);
        weights[static_cast<std::size_t>(i)] = std::exp(-0.5f * x * x);
    }
    return weights;
}

class Filter {
  public:
    Filter(const CameraView& view, const std::vector<V3f>& light)
        : view_(view), light_(light), falloff_(falloff()) {}

    V3f at(std::size_t pixel) const noexcept {
        const auto x = static_cast<int>(pixel % view_.width);
        const auto y = static_cast<int>(pixel / view_.width);
        const int width = static_cast<int>(view_.width), height = static_cast<int>(view_.height);
        const float depth = view_.view_positions[pixel].z;
        V3f sum(0.0f);
        float weights = 0.0f;
        for (int j = std::max(y - kRadius, 0); j <= std::min(y + kRadius, height - 1); ++j) {
            for (int i = std::max(x - kRadius, 0); i <= std::min(x + kRadius, width - 1); ++i) {
                const std::size_t other =
                    view_.index(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j));
                if (view_.hit[other] == 0) continue;
                const float weight = falloff_[static_cast<std::size_t>(std::abs(i - x))] *
                                     falloff_[static_cast<std::size_t>(std::abs(j - y))] *
                                     likeness(view_.surfaces[pixel], view_.surfaces[other], depth);
                sum += light_[other] * weight;
                weights += weight;
            }
        }
        return sum / weights;
    }

  private:
    const CameraView& view_;
    const std::vector<V3f>& light_;
    std::array<float, kRadius + 1> falloff_;
};

}  // namespace

void filter_cross_bilateral(const CameraView& view, Span<V3f> pixels) {
    std::vector<V3f> light(pixels.size());
    constexpr std::size_t kBlock = 1024;
    for_each_block(pixels.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (view.hit[i] != 0) light[i] = pixels[i] / reflectance(view.surfaces[i]);
        }
    });
    const Filter filter(view, light);
    for_each_block(pixels.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (view.hit[i] != 0) pixels[i] = filter.at(i) * reflectance(view.surfaces[i]);
        }
    });
}

}  // namespace lightcull
