#pragma once

#include <algorithm>
#include <cstdint>

#include "base/refine.h"
#include "base/scramble.h"

namespace lightcull {

/// Weighted reservoir sampling of one light: each candidate replaces the choice so far with its
/// share of all weight seen. The random number of a candidate is a hash of u and of the candidate.
class Reservoir {
  public:
    static constexpr std::uint32_t kStride = 0x9e3779b9u;
    static constexpr float kBelowOne = 1.0f - 0x1p-23f;

    /// u in [0, 1): it decides everything.
    explicit Reservoir(float u) noexcept : u_bits_(float_bits(u)) {}

    /// Adds a light. weight: > 0 and finite. The probability of the light that is chosen in the end
    /// is numerator / weight_sum().
    void add(std::uint32_t light, float numerator, float weight) noexcept {
        weight_sum_ += weight;
        const std::uint32_t bits = scramble(u_bits_ ^ (light * kStride));
        // The number is below 1, so that the first is taken, and fine near 0, where the lightest
        // are.
        const float random = std::min(static_cast<float>(bits) * 0x1p-32f, kBelowOne);
        if (random * weight_sum_ < weight) {
            light_ = light;
            numerator_ = numerator;
        }
    }

    /// True if there was any candidate.
    bool chosen() const noexcept { return weight_sum_ > 0.0f; }
    std::uint32_t light() const noexcept { return light_; }
    float weight_sum() const noexcept { return weight_sum_; }
    float prob() const noexcept { return numerator_ / weight_sum_; }

  private:
    std::uint32_t u_bits_;
    float weight_sum_ = 0.0f;
    std::uint32_t light_ = 0;
    float numerator_ = 0.0f;
};

}  // namespace lightcull
