#pragma once

#include <lightcull/export.h>
#include <lightcull/light_sampler.h>
#include <lightcull/render/scene.h>
#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>
#include <memory>

namespace lightcull {

/// Shadow rays from points towards the lights chosen for them, to measure what one costs.
class LIGHTCULL_EXPORT ShadowRays {
  public:
    /// Makes a ray for each point whose selection has a prob above 0, to the middle of the light's
    /// bounds, or to a directional light. The scene must be committed and stay alive; selections
    /// are of its lights, one per point. Throws Error.
    ShadowRays(const Scene& scene, Span<const ShadingPoint> points,
               Span<const Selection> selections);
    ~ShadowRays();

    std::size_t size() const noexcept;

    /// Traces all of them, in the caller's TBB arena. Returns how many reach their light. arrived:
    /// empty, or of size(): where a flag for each is written.
    std::size_t trace(Span<std::uint8_t> arrived = {}) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace lightcull
