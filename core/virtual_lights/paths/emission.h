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

    /// Nothing emits.
    bool empty() const noexcept { return table_.empty(); }
    /// One ray, with all flux of the scene in the mean. Not of an empty one.
    LightRay sample(const PathRandom& random) const noexcept;

    /// A ray of the environment, which there must be, with all its flux in the mean: through a disk
    /// that hides the sphere around the scene, equal areas of the unit square to equal areas of it.
    LightRay environment_ray(const PathRandom& random, const V2f& u) const noexcept;

  private:
    const SceneData& scene_;
    V3f center_{0.0f};  // of a sphere around all geometry
    float radius_ = 0.0f;
    AliasTable table_;  // the emitters, then the environment
};

/// A ray of a spot: u in the unit square goes to its cone, equal areas to equal solid angles.
LightRay spot_ray(const SpotEmitter& spot, const V2f& u) noexcept;

}  // namespace lightcull
