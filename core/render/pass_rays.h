#pragma once

#include "base/random.h"
#include "render/camera.h"
#include "render/pixel_numbers.h"

#include <lightcull/render/renderer.h>

#include <cstdint>

namespace lightcull {

/// The camera rays of a pass, one for each pixel.
///
/// Their places in a pixel follow the R2 sequence (M. Roberts 2018) from pass to pass, shifted by
/// random numbers of the pixel's own (Cranley & Patterson 1976). Each is uniform by itself, and
/// together they fill the pixel evenly: at the edges of what is seen, bright lights above all, the
/// error is far below that of independent places.
class PassRays {
  public:
    PassRays(const CameraRays& camera, const RenderSettings& settings, std::uint64_t pass) noexcept
        : camera_(camera),
          width_(settings.width),
          lens_(hash(~settings.seed, std::uint64_t{1}), pass, 0),
          shift_key_(hash(~settings.seed, std::uint64_t{0})),
          steps_(static_cast<std::uint32_t>(pass)) {}

    Ray ray(std::uint32_t pixel) const noexcept {
        const std::uint32_t x = pixel % width_, y = pixel / width_;
        const V2f corner(static_cast<float>(x), static_cast<float>(y));
        V2f lens(0.0f);
        if (camera_.has_lens()) lens = PixelNumbers(lens_, pixel).lens();
        return camera_.ray(corner + place(pixel), lens);
    }

    const CameraRays& camera() const noexcept { return camera_; }

  private:
    V2f place(std::uint32_t pixel) const noexcept {
        // 1 / g and 1 / g^2 for g^3 = g + 1, as fractions of 2^32.
        constexpr std::uint32_t kStepX = 3242174889u, kStepY = 2447445414u;
        const std::uint64_t shift = hash(shift_key_, pixel);
        const auto x = static_cast<std::uint32_t>(shift) + steps_ * kStepX;
        const auto y = static_cast<std::uint32_t>(shift >> 32) + steps_ * kStepY;
        return {static_cast<float>(x >> 8) * 0x1p-24f, static_cast<float>(y >> 8) * 0x1p-24f};
    }

    const CameraRays& camera_;
    std::uint32_t width_;
    PixelNumbers::Shared lens_;
    std::uint64_t shift_key_;
    std::uint32_t steps_;
};

}  // namespace lightcull
