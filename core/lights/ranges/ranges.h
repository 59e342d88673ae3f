#pragma once

#include <lightcull/span.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "base/scramble.h"
#include "lights/light/importance.h"
#include "lights/ranges/pattern.h"

namespace lightcull {

/// A light, or lights that share a range, as ranges see them: units of a LightTable.
struct RangedLight {
    float3 center;
    float radius;     ///< radius of a sphere that holds it
    float intensity;  ///< intensity of all of it

    /// The distance from a point to that sphere; 0 inside.
    float distance(const Approach& way) const noexcept {
        return std::max(way.distance - radius, 0.0f);
    }
};
static_assert(sizeof(RangedLight) == 20 && alignof(RangedLight) == 4);
static_assert(offsetof(RangedLight, radius) == 12 && offsetof(RangedLight, intensity) == 16);

/// The law that a light's range follows.
enum class RangeLaw {
    kRandom,    ///< random ranges: [TH16] Eq. 3
    kConstant,  ///< constant ranges, with xi always 1: [TH16] appendix A
};

/// The random ranges of one pass: for each light and set a number xi, its range, and whether a
/// point is within it. Lights are numbered as the caller of these functions likes, always alike.
class RandomRanges {
  public:
    /// reach: E / (2 pi epsilon_max) in the units of a LightTable, so that 1 / alpha_i of [TH16]
    /// Eq. 7 is reach * intensity.
    RandomRanges(float reach, std::uint32_t set_count, RangeLaw law = RangeLaw::kRandom)
        : reach_(reach), law_(law), turns_(set_count) {
        const SetPattern pattern(set_count);
        for (std::uint32_t set = 0; set < set_count; ++set) {
            const std::uint64_t rank = pattern.rank_of(set);
            turns_[set] = {static_cast<std::uint32_t>((rank << 32) / pattern.rotations()),
                           pattern.draw_of(set) * 0x9e3779b9u};
        }
    }

    void begin_pass(std::uint64_t pass) noexcept {
        const std::uint64_t key = mix(pass + 0x51ca11ab1eu);
        key_low_ = static_cast<std::uint32_t>(key);
        key_high_ = static_cast<std::uint32_t>(key >> 32);
    }

    float reach() const noexcept { return reach_; }
    std::uint32_t set_count() const noexcept { return static_cast<std::uint32_t>(turns_.size()); }

    // The numbers that xi() is made from, for other back ends.
    std::uint32_t key_low() const noexcept { return key_low_; }
    std::uint32_t key_high() const noexcept { return key_high_; }
    /// The way in which a set takes the numbers of a pass.
    struct Turn {
        std::uint32_t rank;  ///< rotation of the numbers, as a fraction of 2^32
        std::uint32_t draw;  ///< draw that is rotated, as a number to hash
    };
    Span<const Turn> turns() const noexcept { return turns_; }

    /// xi_i of the light in a set: uniform in (0, 1], independent from light to light and draw to
    /// draw, and turned by the rank of the set among those of its draw (SetPattern). The exponent
    /// is a full one: 2^-56 can occur.
    float xi(std::uint32_t light, std::uint32_t set) const noexcept {
        return turned(digits(light, set), set);
    }

    /// The distance, from a light's bounding sphere, at which p_i falls to xi: [TH16] Eq. 3.
    float range(float intensity, float xi) const noexcept {
        return std::sqrt(limit(intensity) / xi);
    }

    /// The ranges of a light in sets first_set and following.
    template <std::size_t kSets>
    void ranges(std::uint32_t light, std::uint32_t first_set, float intensity,
                std::array<float, kSets>& out) const noexcept {
        // Sets that are refitted together are of one draw.
        const Digits of_light = digits(light, first_set);
        for (std::uint32_t i = 0; i < kSets; ++i) {
            out[i] = range(intensity, turned(of_light, first_set + i));
        }
    }

    /// The square of the range of a light of that intensity at xi = 1, which is 1 / alpha_i.
    float limit(float intensity) const noexcept {
        return std::max(reach_ * intensity, kLeastLimit);
    }

    /// True if p_i > xi_i for the range that xi_i gives. The sphere tree tests its leaves by the
    /// same arithmetic.
    bool accepts(const RangedLight& light, const Approach& way, float xi) const noexcept {
        const float radius = range(light.intensity, xi) + light.radius;
        return way.distance2 <= radius * radius;
    }

    /// The inverse 1 / p_i at a distance from the bounding sphere, 0 inside: [TH16] Eq. 1.
    float inverse_prob(float intensity, float distance) const noexcept {
        return std::max(distance * distance * (1.0f / limit(intensity)), 1.0f);
    }

    /// The least limit(), which has an inverse.
    static constexpr float kLeastLimit = 1e-36f;

  private:
    /// The digits of xi before it is turned, as high * 2^-32 + low * 2^-56.
    struct Digits {
        std::uint32_t high;
        float low;
    };

    Digits digits(std::uint32_t light, std::uint32_t set) const noexcept {
        if (law_ == RangeLaw::kConstant) return {0xffffffffu, 0x1p24f};
        const std::uint32_t high =
            scramble(scramble(light ^ key_low_) + key_high_ + turns_[set].draw);
        return {high, static_cast<float>(scramble(high + key_low_) >> 8) + 1.0f};
    }
    float turned(Digits digits, std::uint32_t set) const noexcept {
        return (static_cast<float>(digits.high + turns_[set].rank) + digits.low * 0x1p-24f) *
               0x1p-32f;
    }

    float reach_;
    RangeLaw law_;
    std::uint32_t key_low_ = 0, key_high_ = 0;
    std::vector<Turn> turns_;
};

}  // namespace lightcull
