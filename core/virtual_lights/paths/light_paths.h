#pragma once

#include "virtual_lights/light/virtual_light.h"
#include "virtual_lights/paths/emission.h"

#include <cstdint>
#include <vector>

namespace lightcull {

/// The first rays of `count` light paths, which share the flux of the scene. There are none if
/// nothing emits. key: key of the random numbers, here and below.
std::vector<LightRay> emit(const EmissionTable& emission, std::uint32_t count, std::uint64_t key);

/// Throws Error if anything emits that can have no reflective shadow map.
void check_shadow_map_sources(const SceneData& scene);

/// The rays of reflective shadow maps: of a map of each spot of the scene, a ray for each of its
/// texels, which are edge * edge and part the spot's cone evenly; and of one of the environment,
/// whose texels part evenly what of the scene is seen from where it shines. Nothing else emits.
std::vector<LightRay> shadow_map_rays(const SceneData& scene, const EmissionTable& emission,
                                      std::uint32_t edge, std::uint64_t key);

/// The virtual lights where light paths meet surfaces, up to `bounces` >= 1 to a path, in an order
/// along a Morton curve. Runs in the caller's TBB arena.
std::vector<VirtualLight> virtual_lights(const SceneData& scene,
                                         const std::vector<LightRay>& starts, std::uint32_t bounces,
                                         std::uint64_t key);

}  // namespace lightcull
