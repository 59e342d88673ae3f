#pragma once

#include "virtual_lights/maps/imperfect_shadow_maps.h"
#include "virtual_lights/tiles/prepared_lights.h"
#include "virtual_lights/tiles/tiled_lighting.h"
#include "virtual_lights/volumes/acceptance.h"

#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightcull {

/// The lights of a pass, with all that is the same for every pixel.
struct PassLights {
    const LightingPass& pass;
    const PreparedLights& lights;
    const Acceptance& acceptance;
    const ImperfectShadowMaps* maps;  ///< shadow maps; null without
    float nearest2;                   ///< square of a distance: nearest_distance2()

    /// The subset of the lights that a pixel has: each pixel of a square has another, and another
    /// one in each pass.
    std::uint32_t subset_of(std::uint32_t x, std::uint32_t y) const noexcept;
};

/// Lights pixels, one light at a time. An object is for one thread.
class PixelLighting {
  public:
    PixelLighting(const PassLights& lights, Span<V3f> pixels)
        : of_pass_(lights), scale_(static_cast<float>(lights.lights.subsets())), pixels_(pixels) {}

    /// Adds all lights of a list, as add() does.
    void add_all(std::size_t pixel, const PreparedLights::List& list);
    /// Adds the light that a listed light gives a pixel that shows a surface, but for what waits
    /// for a ray.
    void add(std::size_t pixel, const PreparedLights::Listed& listed) {
        const V3f way = listed.position - of_pass_.pass.view.surfaces[pixel].position;
        const float distance2 = way.dot(way);
        if (distance2 > 0.0f && distance2 <= listed.farthest2) {
            add_near(pixel, listed.index, way, distance2);
        }
    }
    /// Adds the light that shadow rays let through. It is called between one pixel and the next.
    void finish(std::size_t pixel);

    /// Notes how many lights a pixel has listed.
    void count(std::size_t pixel, std::size_t listed);
    const LightingCounts& counts() const noexcept { return counts_; }

  private:
    void add_near(std::size_t pixel, std::uint32_t index, const V3f& way, float distance2);

    const PassLights& of_pass_;
    float scale_;
    Span<V3f> pixels_;
    LightingCounts counts_;
    std::vector<Ray> rays_;
    std::vector<V3f> values_;
    std::vector<std::uint8_t> occluded_;
};

}  // namespace lightcull
