#pragma once

#include <cstdint>

#include "base/random.h"
#include "lights/refine.h"

namespace lightcull {

/// Weighted reservoir sampling of one light, by a buffer: candidates are summed up in blocks, and
/// each block as a whole replaces the choice so far with its share of all weight seen.
class Reservoir {
  public:
    struct Choice {
        std::uint32_t light = 0;
        float numerator = 0.0f;  ///< what add() was told
        float weight = 0.0f;     ///< 0: nothing was chosen
    };

    /// u in [0, 1): decides everything.
    explicit Reservoir(float u) noexcept : u_(u) {}

    /// weight > 0 and finite. Of the light that is chosen in the end, numerator / weight_sum() is
    /// the probability.
    void add(std::uint32_t light, float numerator, float weight) noexcept {
        if (size_ == kCapacity) flush();
        buffer_[size_++] = {light, numerator, weight};
    }

    /// The choice, in proportion to weight; call it after the last add().
    const Choice& finish() noexcept {
        flush();
        return choice_;
    }
    float weight_sum() const noexcept { return weight_sum_; }

  private:
    static constexpr std::uint32_t kCapacity = 64;

    void flush() noexcept {
        float block_sum = 0.0f;
        for (std::uint32_t i = 0; i < size_; ++i) block_sum += buffer_[i].weight;
        weight_sum_ += block_sum;
        const float target = block_random() * weight_sum_;
        // Summed as before, so the last sum is block_sum, which is above target.
        float sum = 0.0f;
        for (std::uint32_t i = 0; target < block_sum && i < size_; ++i) {
            sum += buffer_[i].weight;
            if (target < sum) {
                choice_ = buffer_[i];
                break;
            }
        }
        size_ = 0;
        ++block_;
    }

    float block_random() const noexcept {
        if (block_ == 0) return u_;
        return uniform_float(hash(float_bits(u_), block_));
    }

    float u_;
    float weight_sum_ = 0.0f;
    std::uint32_t size_ = 0, block_ = 0;
    Choice choice_;
    Choice buffer_[kCapacity];
};

}  // namespace lightcull
