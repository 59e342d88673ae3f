#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "lights/light_record.h"
#include "lights/pattern.h"

namespace lightcull {

/// The random ranges of one pass: for each light and set a number xi, its range, and whether a
/// point is within it. Lights are numbered as the caller of these functions likes, always alike.
class RandomRanges {
  public:
    /// reach: E / (2 pi epsilon_max) in the units of a LightTable, so that 1 / alpha_i of [TH16]
    /// Eq. 7 is reach * intensity.
    RandomRanges(float reach, std::uint32_t set_count) : reach_(reach), ranks_(set_count) {
        const std::uint32_t log4_sets = log4_of(set_count);
        const std::uint32_t shift = 32 - 2 * log4_sets;
        for (std::uint32_t set = 0; set < set_count; ++set) {
            ranks_[set] = set_count == 1 ? 0 : rank_of_set(set, log4_sets) << shift;
        }
    }

    void begin_pass(std::uint64_t pass) noexcept {
        const std::uint64_t key = mix(pass + 0x51ca11ab1eu);
        key_low_ = static_cast<std::uint32_t>(key);
        key_high_ = static_cast<std::uint32_t>(key >> 32);
    }

    std::uint32_t set_count() const noexcept { return static_cast<std::uint32_t>(ranks_.size()); }

    /// xi_i of the light in a set: uniform in (0, 1], independent from light to light, and in set s
    /// that of set 0 turned by rank(s) / set_count. The exponent is a full one: 2^-56 can occur.
    float xi(std::uint32_t light, std::uint32_t set) const noexcept {
        const std::uint32_t high = scramble(scramble(light ^ key_low_) + key_high_);
        const std::uint32_t low = scramble(high + key_low_) >> 8;
        const auto turned = static_cast<float>(high + ranks_[set]);
        return (turned + (static_cast<float>(low) + 1.0f) * 0x1p-24f) * 0x1p-32f;
    }

    /// The distance, from a light's bounding sphere, at which p_i falls to xi: [TH16] Eq. 3.
    float range(float intensity, float xi) const noexcept {
        return std::sqrt(reach_ * intensity / xi);
    }

    /// p_i at a distance from the bounding sphere, 0 inside: [TH16] Eq. 1.
    float prob(float intensity, float distance) const noexcept {
        const float limit = reach_ * intensity, distance2 = distance * distance;
        return distance2 <= limit ? 1.0f : limit / distance2;
    }

    /// p_i >= xi, without a division.
    bool accepts(float intensity, float distance, float xi) const noexcept {
        return distance * distance * xi <= reach_ * intensity;
    }

  private:
    /// The finaliser of MurmurHash3 for 32 bits, which GPUs have arithmetic for.
    static constexpr std::uint32_t scramble(std::uint32_t x) noexcept {
        x = (x ^ (x >> 16)) * 0x85ebca6bu;
        x = (x ^ (x >> 13)) * 0xc2b2ae35u;
        return x ^ (x >> 16);
    }

    float reach_;
    std::uint32_t key_low_ = 0, key_high_ = 0;
    std::vector<std::uint32_t> ranks_;  ///< by set, as a fraction of 2^32
};

/// From a point to a light's bounding sphere; 0 inside.
inline float distance_to_sphere(float distance_to_center, const LightRecord& light) noexcept {
    return std::max(distance_to_center - light.radius, 0.0f);
}

}  // namespace lightcull
