#include "virtual_lights/view/a_trous.h"

#include "base/parallel_blocks.h"
#include "virtual_lights/view/likeness.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lightcull {
namespace {

constexpr int kLevels = 4;
/// The weights of the cubic B-spline, from the middle on.
constexpr float kKernel[] = {3.0f / 8.0f, 1.0f / 4.0f, 1.0f / 16.0f};
/// The difference of two numbers that lie across an edge, at the first level; each further level
/// takes half of it.
constexpr float kEdge = 1.0f;

class Level {
  public:
    Level(const CameraView& view, const std::vector<float>& values, int level)
        : view_(view),
          values_(values),
          step_(1 << level),
          inverse_edge_(static_cast<float>(step_) / kEdge) {}

    float at(std::size_t pixel) const noexcept {
        const auto x = static_cast<int>(pixel % view_.width);
        const auto y = static_cast<int>(pixel / view_.width);
        float sum = 0.0f, weights = 0.0f;
        for (int j = -2; j <= 2; ++j) {
            for (int i = -2; i <= 2; ++i) {
                const int u = x + i * step_, v = y + j * step_;
                if (u < 0 || v < 0 || u >= static_cast<int>(view_.width) ||
                    v >= static_cast<int>(view_.height)) {
                    continue;
                }
                const std::size_t other =
                    view_.index(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v));
                if (values_[other] < 0.0f) continue;
                const float weight =
                    kKernel[std::abs(i)] * kKernel[std::abs(j)] * like(pixel, other);
                sum += weight * values_[other];
                weights += weight;
            }
        }
        return sum / weights;
    }

  private:
    float like(std::size_t pixel, std::size_t other) const noexcept {
        const float difference = (values_[pixel] - values_[other]) * inverse_edge_;
        return std::exp(-difference * difference) * likeness(view_.surfaces[pixel],
                                                             view_.surfaces[other],
                                                             view_.view_positions[pixel].z);
    }

    const CameraView& view_;
    const std::vector<float>& values_;
    int step_;
    float inverse_edge_;
};

}  // namespace

void filter_a_trous(const CameraView& view, std::vector<float>& values) {
    std::vector<float> next(values.size(), -1.0f);
    constexpr std::size_t kBlock = 1024;
    for (int level = 0; level < kLevels; ++level) {
        const Level filter(view, values, level);
        for_each_block(values.size(), kBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (values[i] >= 0.0f) next[i] = filter.at(i);
            }
        });
        values.swap(next);
    }
}

}  // namespace lightcull
