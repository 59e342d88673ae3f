#pragma once

#include <lightcull/export.h>
#include <lightcull/float3.h>
#include <lightcull/render/scene.h>
#include <lightcull/span.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace lightcull {

/// A look at a scene that is not committed, by which its camera and its surroundings can be chosen:
/// the scene itself stays open. What reflects is grey where it has textures.
class LIGHTCULL_EXPORT Preview {
  public:
    /// Takes what is in the scene, whose triangles and vertices it shares until more are added
    /// there. Throws Error if the scene is committed.
    explicit Preview(const Scene& scene);
    ~Preview();

    /// The distance to what each ray meets first, in lengths of its direction: infinite where that
    /// is nothing, and negative where it is the back of a triangle.
    std::vector<float> distances(Span<const float3> origins, Span<const float3> directions) const;

    /// An image of emission and direct light, linear RGB, row 0 at the top: height * width. Pixels
    /// are not numbers where the ray through their middle leaves the scene.
    std::vector<float3> look(const Camera& camera, std::uint32_t width, std::uint32_t height,
                             std::uint32_t passes);

    /// The memory that it takes besides that of the scene, bytes.
    SceneMemory memory_size() const noexcept;

  private:
    std::shared_ptr<Scene> copy_;
};

}  // namespace lightcull
