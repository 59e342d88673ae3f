#pragma once

#include "base/alias_table.h"
#include "render/path_random.h"
#include "render/ray.h"
#include "render/scene_data.h"

namespace lightcull {

/// A ray along which light leaves an emitter, and the flux that it carries, W.
struct LightRay {
    Ray ray;
    V3f flux;
};

/// Draws light rays from all emitters of a scene and its environment, in proportion to their power.
class EmissionTable {
  public:
    /// The scene must outlive it.
    explicit EmissionTable(const SceneData& scene);

    /// True if nothing emits.
    bool empty() const noexcept { return table_.empty(); }
    /// A ray, which carries all flux of the scene in the mean. The table must not be empty.
    LightRay sample(const PathRandom& random) const noexcept;

    /// A ray of the environment, which there must be, with all its flux in the mean: it goes
    /// through a disk that hides the sphere around the scene, and equal areas of the unit square go
    /// to equal areas of the disk.
    LightRay environment_ray(const PathRandom& random, const V2f& u) const noexcept;
    /// A ray of a directional light, likewise.
    LightRay directional_ray(const DirectionalEmitter& sun, const V2f& u) const noexcept;

  private:
    Ray parallel_ray(const V3f& direction, const V2f& u) const noexcept;

    const SceneData& scene_;
    V3f center_{0.0f};  // centre of a sphere around all geometry
    float radius_ = 0.0f;
    AliasTable table_;  // emitters, then the environment
};

/// A ray of a spot: u in the unit square goes to its cone, equal areas to equal solid angles.
LightRay spot_ray(const SpotEmitter& spot, const V2f& u) noexcept;

}  // namespace lightcull
