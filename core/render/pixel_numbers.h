#pragma once

#include "base/random.h"
#include "base/sobol.h"
#include "render/emitter.h"
#include "render/vec.h"

#include <cstdint>

namespace lightcull {

/// The random numbers of one vertex of a pixel's paths. From pass to pass they cover their ranges
/// evenly, those of one use together (SobolPoint); different uses, vertices and pixels are
/// independent.
///
/// `key` must be another where a sampler has changed for what was reported of earlier passes: a
/// pass is unbiased only if its numbers do not depend on those from which its sampler has learned.
class PixelNumbers {
  public:
    PixelNumbers(std::uint64_t key, std::uint64_t pass, std::uint32_t pixel,
                 std::uint32_t depth) noexcept
        : key_(hash(key, pixel, depth)), pass_(pass) {}

    /// u of LightSampler::select(), and the place on the light.
    float select_light() const noexcept { return of(Use::kLight)[0]; }
    PlaceNumbers light_vertex() const noexcept {
        const SobolPoint p = of(Use::kLight);
        return {p.fine(3), pair(p, 1)};
    }

    struct InEnvironment {
        double cell;
        V2f within;
    };
    InEnvironment environment() const noexcept {
        const SobolPoint p = of(Use::kEnvironment);
        return {p.fine(0), pair(p, 1)};
    }

    struct Scatter {
        float last_ray;  ///< tells whether a path's last edge is traced
        V2f direction;
        float lobe;
    };
    Scatter scatter() const noexcept {
        const SobolPoint p = of(Use::kScatter);
        return {p[0], pair(p, 1), p[3]};
    }
    float roulette() const noexcept { return of(Use::kRoulette)[0]; }
    V2f lens() const noexcept { return pair(of(Use::kLens), 0); }

  private:
    enum class Use : std::uint64_t { kLens, kLight, kEnvironment, kScatter, kRoulette };

    SobolPoint of(Use use) const noexcept {
        return {hash(key_, static_cast<std::uint64_t>(use)), pass_};
    }
    static V2f pair(const SobolPoint& p, std::uint32_t first) noexcept {
        return {p[first], p[first + 1]};
    }

    std::uint64_t key_;
    std::uint64_t pass_;
};

}  // namespace lightcull
