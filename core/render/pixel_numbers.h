#pragma once

#include "base/random.h"
#include "base/sobol.h"
#include "render/emitter.h"
#include "render/vec.h"

#include <lightcull/render/renderer.h>

#include <cstdint>

namespace lightcull {

/// The random numbers of one vertex of a pixel's paths. From pass to pass they cover their ranges
/// evenly, those of one use together (SobolPoint); different uses, vertices and pixels are
/// independent.
class PixelNumbers {
  public:
    /// All that the pixels of a pass share at vertices of one depth.
    class Shared {
      public:
        Shared(std::uint64_t key, std::uint64_t pass, std::uint32_t depth) noexcept
            : key_(hash(key, depth)), pass_(pass) {}

      private:
        friend class PixelNumbers;
        std::uint64_t key_;
        SobolIndex pass_;
    };

    PixelNumbers(const Shared& shared, std::uint32_t pixel) noexcept
        : key_(mix(shared.key_ + pixel)), pass_(shared.pass_) {}

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

    /// Tells whether a path's last edge is traced.
    float last_ray() const noexcept { return of(Use::kScatter)[0]; }
    struct Scatter {
        V2f direction;
        float lobe;
    };
    Scatter scatter() const noexcept {
        const SobolPoint p = of(Use::kScatter);
        return {pair(p, 1), p[3]};
    }
    float roulette() const noexcept { return of(Use::kRoulette)[0]; }
    V2f lens() const noexcept { return pair(of(Use::kLens), 0); }

  private:
    enum class Use : std::uint64_t { kLens, kLight, kEnvironment, kScatter, kRoulette };

    SobolPoint of(Use use) const noexcept {
        return {mix(key_ + static_cast<std::uint64_t>(use)), pass_};
    }
    static V2f pair(const SobolPoint& p, std::uint32_t first) noexcept {
        return {p[first], p[first + 1]};
    }

    std::uint64_t key_;
    const SobolIndex& pass_;
};

/// The key of the numbers of a pass of an image.
inline std::uint64_t numbers_key(const RenderSettings& settings, std::uint64_t pass) noexcept {
    constexpr std::uint64_t kForImages = 1;
    return hash(settings.seed, kForImages, settings.even_numbers ? 0 : 1 + pass);
}

}  // namespace lightcull
