#pragma once

#include "base/core_export.h"
#include "render/ray.h"
#include "render/vec.h"

#include <lightcull/render/scene.h>
#include <lightcull/span.h>

#include <cstddef>
#include <cstdint>
#include <memory>

namespace lightcull {

struct SceneData;

/// Finds what rays hit among the triangles of a scene, and those of instances. Where one is cut
/// out, rays go on.
class LIGHTCULL_CORE_EXPORT RayTracer {
  public:
    /// Builds the acceleration structure in the caller's TBB arena. The scene stays where it is,
    /// and its triangles what they are; one more element is readable after the last position.
    /// reach: the largest coordinate, but for its sign, of what rays begin or end at. Throws Error.
    RayTracer(const SceneData& scene, float reach);
    /// Follows positions that have changed, by fitting the acceleration structure, which is built
    /// anew the first time, where it has grown looser than max_growth, and where the positions are
    /// in another place of memory.
    SceneRefit refit(float reach, float max_growth);

    ~RayTracer();
    RayTracer(RayTracer&&) noexcept;
    RayTracer& operator=(RayTracer&&) noexcept;

    /// hits[i] is the first hit of rays[i]. coherent: neighbours go much the same way.
    void intersect(Span<const Ray> rays, Span<Hit> hits, bool coherent) const noexcept;

    /// occluded[i] is 1 if anything hides the end of rays[i], else 0: see hides_end().
    void occluded(Span<const Ray> rays, Span<std::uint8_t> occluded) const noexcept;

    /// The memory that the acceleration structure takes, bytes.
    std::size_t memory_size() const noexcept;

  private:
    struct Handles;
    std::unique_ptr<Handles> handles_;
};

}  // namespace lightcull
